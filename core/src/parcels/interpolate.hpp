// Grid to parcel with the weights of the deposit.
#pragma once
#include <span>

#include "mesh/grid.hpp"
#include "parcels/store.hpp"

namespace pileus::parcels {

/// Doubles per node of the records that are interpolated: those of the deposit.
template <int D>
inline constexpr int interpolated_width = mesh::DepositRecord<D>::width;

/// Fills the levels beyond the walls with the mirror image of those inside, as the deposit folds
/// them: what was gathered beyond a wall belongs to the level inside.
template <int D>
void mirror_halo(const mesh::Grid<D>& grid, double* field);

/// values[f][p] = Σ weight × field[node × width + f] over the support points of parcel p, for its
/// present position and shape; at most `interpolated_width` values. Levels beyond the walls are
/// read.
template <int D>
void interpolate(const Store& store, const mesh::Grid<D>& grid, const double* field,
                 std::span<double* const> values);

}  // namespace pileus::parcels

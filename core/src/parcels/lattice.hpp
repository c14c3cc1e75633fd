// Parcels on a regular sub-lattice of the cells: how every run begins.
#pragma once
#include <cstdint>

#include "mesh/grid.hpp"
#include "parcels/store.hpp"

namespace pileus::parcels {

/// m for m^dimension parcels per cell, or 0 when `per_cell` is no such power.
int parcels_per_direction(int per_cell, int dimension);

/// Fills the store with per_cell = m^D equal parcels per cell on the regular sub-lattice, as
/// ellipsoids with the cell's aspect ratio that touch the volume per parcel exactly; vorticity and
/// scalars zero. `jitter` moves every centre by up to that fraction of the lattice spacing in each
/// direction (uniform, keyed by seed and parcel identity), kept inside the walls. Identities are
/// 1, 2, … in lattice order, so the result does not depend on threads.
template <int D>
void fill_lattice(Store& store, const mesh::Grid<D>& grid, int per_cell, double jitter,
                  std::uint64_t seed);

}  // namespace pileus::parcels

// Parcels on a regular sub-lattice of the cells: how every run begins.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/grid.hpp"
#include "parcels/store.hpp"

namespace pileus::parcels {

/// m for m^dimension parcels per cell, or 0 when `per_cell` is no such power.
int parcels_per_direction(int per_cell, int dimension);

/// Where the parcels of a lattice lie in the cells.
struct LatticeControl {
  int per_cell = 8;        // m^D
  double offset = 0.5;     // of the first point from a cell's corner, in lattice spacings
  double jitter = 0;       // largest random displacement, in lattice spacings
  std::uint64_t seed = 0;  // of the displacements
};

/// Fills the store with per_cell = m^D equal parcels per cell on the regular sub-lattice, as
/// ellipsoids with the cell's aspect ratio that touch the volume per parcel exactly; vorticity and
/// scalars zero. `jitter` moves every centre by up to that fraction of the lattice spacing in each
/// direction (uniform, keyed by seed and parcel identity), kept inside the walls. Identities are
/// 1, 2, … in lattice order, so the result does not depend on threads.
template <int D>
void fill_lattice(Store& store, const mesh::Grid<D>& grid, const LatticeControl& control);

/// Leaves the parcels whose entry of `indicator` is positive, each larger by the same factor, so
/// that the sum of volumes stays; their order and identities stay too. The number that is left.
std::size_t keep_positive(Store& store, const std::vector<double>& indicator);

}  // namespace pileus::parcels

// Keeping parcels in the domain: periodic wrap and reflection at the walls.
#pragma once
#include "mesh/grid.hpp"
#include "parcels/store.hpp"

namespace pileus::parcels {

/// Wraps horizontal positions into [lower, lower + extent) for any distance outside; reflects
/// parcels beyond a wall, with their shapes (B13 and B23 change sign, vorticity does not: it is the
/// parcel that turns back, not the flow). A parcel still outside after one reflection is put on the
/// nearest wall.
template <int D>
void confine(Store& store, const mesh::Grid<D>& grid);

/// Wraps horizontally and holds the height between the walls, without touching the shape: for small
/// displacements that are not motion with the flow.
template <int D>
void hold_inside(Store& store, const mesh::Grid<D>& grid, std::size_t p);

/// confine() for parcel p alone.
template <int D>
void confine(Store& store, const mesh::Grid<D>& grid, std::size_t p);

}  // namespace pileus::parcels

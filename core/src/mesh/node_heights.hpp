// Gathered buoyancy, referred to the heights of the nodes.
//
// A node holds the mean buoyancy of the parcels about it, whose mean height z̄ is not the node's: in
// stratified air N²(z̄ − z) varies along a level wherever parcels lie unevenly, though nothing is
// out of balance. Its curl is the same in every step, and next to a wall, where nothing can move up
// or down to balance it, it turns the air for ever: scattered parcels at rest would set themselves
// in motion. Therefore
//   b_k ← b_k − (z̄_k − h_k) s_k,   s_k = (b_{k+1} − b_{k−1})/(z̄_{k+1} − z̄_{k−1}),
// with the differences of what was gathered over those of the heights where it was, one-sided at
// walls. Buoyancy that is linear in height comes out as itself at h_k, wherever the parcels are.
// h_k is the height of the node and, at a wall, which gathers from one side, that of air which
// fills the cell evenly: Δz ∫ζ(1−ζ)dζ / ∫(1−ζ)dζ = Δz/3 inside. Only the flow is touched, never a
// parcel's own property.
#pragma once
#include "mesh/grid.hpp"

namespace pileus::mesh {

/// Lane of a deposited record with the mean height of what was gathered (m), behind the buoyancy.
template <int D>
inline constexpr int mean_height = DepositRecord<D>::first_spare;
/// The same lane afterwards: the buoyancy as it was gathered, a mean of parcels, for outputs.
template <int D>
inline constexpr int gathered_buoyancy = mean_height<D>;

/// Refers the buoyancy of deposited records to h, in place, at the levels 0 … n_z, and leaves what
/// was gathered in the lane of the heights. Empty nodes keep what they have and are left out of
/// their neighbours' slopes.
template <int D>
void refer_buoyancy_to_nodes(const Grid<D>& grid, double* records);

}  // namespace pileus::mesh

// What operators may ask of the gridded flow, by the names of schemas/quantities.yaml.
#pragma once
#include <string_view>

#include "mesh/grid.hpp"

namespace pileus::mesh {

/// True if `name` is a velocity component, a component of the velocity gradient
/// (z_derivative_of_x_velocity = ∂u/∂z), or the strain rate magnitude, in some dimension.
bool is_flow_quantity(std::string_view name);

/// Position of a flow quantity in the list of dimension D, or −1.
template <int D>
int find_flow_quantity(std::string_view name);

/// Writes flow quantity `which` of every node, levels beyond the walls included, to
/// records[node × width + lane]. |S| = √(2 S_ij S_ij), S = ½(∇u + ∇uᵀ); ∂w/∂z follows from
/// continuity.
template <int D>
void copy_flow_quantity(const Grid<D>& grid, const double* flow, int which, double* records,
                        int width, int lane);

}  // namespace pileus::mesh

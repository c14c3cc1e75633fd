#include "mesh/flow_quantities.hpp"

#include <array>
#include <cmath>

#include "base/parallel.hpp"

namespace pileus::mesh {
namespace {

constexpr int vertical_stretching = -1, strain_rate = -2;  // computed from the record

struct NamedValue {
  std::string_view name;
  int at;  // in the flow record, or one of the two above
};

template <int D>
struct Names;
template <>
struct Names<3> {
  using R = FlowRecord<3>;
  static constexpr std::array<NamedValue, 13> list = {
      {{"x_velocity", R::u},
       {"y_velocity", R::v},
       {"z_velocity", R::w},
       {"x_derivative_of_x_velocity", R::u_x},
       {"y_derivative_of_x_velocity", R::u_y},
       {"z_derivative_of_x_velocity", R::u_z},
       {"x_derivative_of_y_velocity", R::v_x},
       {"y_derivative_of_y_velocity", R::v_y},
       {"z_derivative_of_y_velocity", R::v_z},
       {"x_derivative_of_z_velocity", R::w_x},
       {"y_derivative_of_z_velocity", R::w_y},
       {"z_derivative_of_z_velocity", vertical_stretching},
       {"strain_rate_magnitude", strain_rate}}};
};
template <>
struct Names<2> {
  using R = FlowRecord<2>;
  static constexpr std::array<NamedValue, 7> list = {
      {{"x_velocity", R::u},
       {"z_velocity", R::w},
       {"x_derivative_of_x_velocity", R::u_x},
       {"z_derivative_of_x_velocity", R::u_z},
       {"x_derivative_of_z_velocity", R::w_x},
       {"z_derivative_of_z_velocity", vertical_stretching},
       {"strain_rate_magnitude", strain_rate}}};
};

double stretching(const double* r, const Grid<3>&) {
  return -(r[FlowRecord<3>::u_x] + r[FlowRecord<3>::v_y]);
}
double stretching(const double* r, const Grid<2>&) {
  return -r[FlowRecord<2>::u_x];
}

double strain(const double* r, const Grid<3>& grid) {
  using R = FlowRecord<3>;
  const double w_z = stretching(r, grid);
  const double xy = r[R::u_y] + r[R::v_x], xz = r[R::u_z] + r[R::w_x], yz = r[R::v_z] + r[R::w_y];
  return std::sqrt(2 * (r[R::u_x] * r[R::u_x] + r[R::v_y] * r[R::v_y] + w_z * w_z) + xy * xy +
                   xz * xz + yz * yz);
}
double strain(const double* r, const Grid<2>&) {
  using R = FlowRecord<2>;
  const double xz = r[R::u_z] + r[R::w_x];
  return std::sqrt(4 * r[R::u_x] * r[R::u_x] + xz * xz);
}

}  // namespace

template <int D>
int find_flow_quantity(std::string_view name) {
  for (std::size_t i = 0; i < Names<D>::list.size(); ++i)
    if (Names<D>::list[i].name == name) return static_cast<int>(i);
  return -1;
}

bool is_flow_quantity(std::string_view name) {
  return find_flow_quantity<3>(name) >= 0 || find_flow_quantity<2>(name) >= 0;
}

template <int D>
void copy_flow_quantity(const Grid<D>& grid, const double* flow, int which, double* records,
                        int width, int lane) {
  const int at = Names<D>::list[static_cast<std::size_t>(which)].at;
  parallel_chunks(grid.nodes(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) {
      const double* r = flow + node * FlowRecord<D>::width;
      records[node * static_cast<std::size_t>(width) + static_cast<std::size_t>(lane)] =
          at == strain_rate           ? strain(r, grid)
          : at == vertical_stretching ? stretching(r, grid)
                                      : r[at];
    }
  });
}

template int find_flow_quantity<2>(std::string_view);
template int find_flow_quantity<3>(std::string_view);
template void copy_flow_quantity(const Grid<2>&, const double*, int, double*, int, int);
template void copy_flow_quantity(const Grid<3>&, const double*, int, double*, int, int);

}  // namespace pileus::mesh

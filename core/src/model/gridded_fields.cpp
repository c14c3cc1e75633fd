#include "model/gridded_fields.hpp"

#include <fmt/format.h>

#include "base/aligned_array.hpp"
#include "base/error.hpp"
#include "mesh/flow_solver.hpp"
#include "mesh/node_heights.hpp"
#include "output/grid_fields.hpp"

namespace pileus::model {

template <int D>
std::vector<output::Variable> GriddedFields<D>::list() const {
  std::vector<output::Variable> fields;
  if constexpr (D == 3)
    fields = {{"x_velocity", "m s-1", "velocity in x"},
              {"y_velocity", "m s-1", "velocity in y"},
              {"z_velocity", "m s-1", "upward velocity", "upward_air_velocity"},
              {"x_vorticity", "s-1", "vorticity component in x"},
              {"y_vorticity", "s-1", "vorticity component in y"},
              {"z_vorticity", "s-1", "upward component of vorticity",
               "atmosphere_upward_relative_vorticity"}};
  else
    fields = {{"x_velocity", "m s-1", "velocity in x"},
              {"z_velocity", "m s-1", "upward velocity", "upward_air_velocity"},
              {"vorticity", "s-1", "vorticity dw/dx - du/dz"}};
  fields.push_back({"buoyancy", "m s-2", "buoyancy"});
  fields.push_back({"volume", D == 3 ? "m3" : "m2", "volume of parcels gathered at a node"});
  for (const parcels::Scalar& s : in_.store.scalars())
    if (s.name != "buoyancy") fields.push_back({s.name, s.units, s.name});
  return fields;
}

/// What the last evaluation left on the mesh; whether `name` is there.
template <int D>
bool GriddedFields<D>::take_from_mesh(const std::string& name, std::vector<double>& values) const {
  using Flow = mesh::FlowRecord<D>;
  using Record = mesh::DepositRecord<D>;
  if (name == "volume") {
    output::copy_nodes(in_.grid, in_.transport.deposited(), Record::width, Record::volume, values);
    return true;
  }
  if (name == "buoyancy") {
    output::copy_nodes(in_.grid, in_.transport.deposited(), Record::width,
                       mesh::gathered_buoyancy<D>, values);
    for (int k = 0; k <= in_.grid.nz(); ++k) {
      const double b = in_.reference(in_.grid.bottom() + k * in_.grid.spacing[D - 1]);
      for (std::size_t c = 0; c < in_.grid.columns(); ++c)
        values[static_cast<std::size_t>(k) * in_.grid.columns() + c] += b;
    }
    return true;
  }
  static const std::vector<std::string> directions =
      D == 3 ? std::vector<std::string>{"x", "y", "z"} : std::vector<std::string>{"x", "z"};
  for (std::size_t d = 0; d < directions.size(); ++d)
    if (name == directions[d] + "_velocity") {
      output::copy_nodes(in_.grid, in_.transport.flow(), Flow::width, static_cast<int>(d), values);
      return true;
    }
  constexpr int components = Record::vorticity_components;
  for (int c = 0; c < components; ++c)
    if (name == (components == 1 ? "" : directions[std::size_t(c)] + "_") + "vorticity") {
      AlignedArray<double> vorticity(in_.grid.nodes() * components);
      mesh::grid_vorticity<D>(in_.grid, in_.transport.flow(), vorticity.data());
      output::copy_nodes(in_.grid, vorticity.data(), components, c, values);
      return true;
    }
  return false;
}

template <int D>
void GriddedFields<D>::grid(const std::vector<std::string>& names,
                            std::vector<std::vector<double>>& values) const {
  constexpr int width = mesh::DepositRecord<D>::width;
  values.resize(names.size());
  std::vector<std::size_t> place;  // of the scalars that wait for a pass
  std::vector<const double*> waiting;
  AlignedArray<double> field;
  const auto gather = [&] {
    field.discard_and_resize(in_.grid.nodes() * width);
    in_.transport.deposit().means(in_.store, in_.tile_begin, waiting, {}, field.data());
    for (std::size_t i = 0; i < place.size(); ++i)
      output::copy_nodes(in_.grid, field.data(), width, int(i) + 1, values[place[i]]);
    place.clear();
    waiting.clear();
  };
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (take_from_mesh(names[n], values[n])) continue;
    const int scalar = in_.store.find_scalar(names[n]);
    if (scalar < 0) throw Error(ExitCode::usage, fmt::format("There is no field '{}'.", names[n]));
    place.push_back(n);
    waiting.push_back(in_.store.scalar(scalar));
    if (waiting.size() + 1 == width) gather();
  }
  if (!waiting.empty()) gather();
}

template class GriddedFields<2>;
template class GriddedFields<3>;

}  // namespace pileus::model

// A cloud of parcels on a mesh whose flow is a given function of the node, for operators that read
// the mesh: the core's own deposit and interpolation, no inversion.
#pragma once
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../parcels/parcel_cloud.hpp"
#include "coupling/operator_sequence.hpp"
#include "mesh/flow_quantities.hpp"
#include "parcels/deposit.hpp"
#include "parcels/interpolate.hpp"
#include "parcels/upkeep.hpp"
#include "parcels/walls.hpp"

namespace pileus::testing {

/// Value of a flow quantity of the given name at a node (its index in the field).
using NodeFunction = std::function<double(std::string_view name, std::size_t node)>;

template <int D>
class SampledMesh final : public coupling::MeshAccess {
 public:
  SampledMesh(const mesh::Grid<D>& grid, parcels::Store& store, NodeFunction flow)
      : grid_(grid), store_(store), flow_(std::move(flow)), deposit_(grid) {}

  /// Puts the parcels into cell order, which a deposit relies on.
  void reorder() {
    parcels::Upkeep<D> upkeep(grid_, deposit_.tiling(), 0,
                              parcels::SplitCriterion<D>::make(grid_, 4, 2.89));
    parcels::SupportOffsets<D> offsets;
    PhaseTimes times;
    upkeep.reorder(store_, offsets, times);
    tile_begin_ = upkeep.tile_begin();
  }
  std::size_t nodes() const override { return grid_.nodes(); }
  int levels() const override { return grid_.levels(); }
  int record_width() const override { return parcels::interpolated_width<D>; }
  void deposit(std::span<const double* const> values, double* field) override {
    ++deposits;
    deposit_.means(store_, tile_begin_, {values.begin(), values.end()}, {}, field);
  }
  void mirror(double* field) const override { parcels::mirror_halo(grid_, field); }
  void interpolate(const double* field, std::span<double* const> values) const override {
    parcels::interpolate(store_, grid_, field, values);
  }
  void evaluate_flow() override { ++evaluations; }
  int find_flow_quantity(std::string_view name) const override {
    if (mesh::find_flow_quantity<D>(name) < 0) return -1;
    const auto known = std::find(names_.begin(), names_.end(), name);
    if (known != names_.end()) return static_cast<int>(known - names_.begin());
    names_.emplace_back(name);
    return static_cast<int>(names_.size()) - 1;
  }
  void copy_flow_quantity(int which, double* field, int lane) const override {
    for (std::size_t node = 0; node < grid_.nodes(); ++node)
      field[node * static_cast<std::size_t>(record_width()) + static_cast<std::size_t>(lane)] =
          flow_(names_[static_cast<std::size_t>(which)], node);
  }
  double* domain_value(std::string_view name) override {
    for (std::size_t d = 0; d + 1 < std::size_t{D}; ++d)
      if (name == coupling::mean_wind_names[d]) return &mean_wind[d];
    return D == 3 && name == coupling::coriolis_parameter_name ? &coriolis_parameter : nullptr;
  }
  void confine() override { parcels::confine<D>(store_, grid_); }
  void blunt_shapes() override {}

  int deposits = 0, evaluations = 0;
  std::array<double, 2> mean_wind{};  // m s⁻¹
  double coriolis_parameter = 0;      // s⁻¹

 private:
  mesh::Grid<D> grid_;
  parcels::Store& store_;
  NodeFunction flow_;
  parcels::Deposit<D> deposit_;
  std::vector<std::size_t> tile_begin_;
  mutable std::vector<std::string> names_;
};

using Settings = std::vector<std::pair<std::string, std::string>>;

/// The entries of "[a, b, c]".
inline std::vector<std::string> texts_of(const std::string& list) {
  std::vector<std::string> texts;
  std::string rest = list.substr(1, list.size() - 2);
  for (std::size_t at; !rest.empty(); rest = at == rest.npos ? "" : rest.substr(at + 2)) {
    at = rest.find(", ");
    texts.push_back(rest.substr(0, at));
  }
  return texts;
}

/// The lists of "{height: [a, b], value: [c, d]}".
inline std::vector<std::pair<std::string, std::vector<std::string>>> columns_of(
    const std::string& mapping) {
  std::vector<std::pair<std::string, std::vector<std::string>>> columns;
  for (std::size_t at = 1; at < mapping.size();) {
    const std::size_t colon = mapping.find(": ", at), end = mapping.find(']', colon);
    columns.emplace_back(mapping.substr(at, colon - at),
                         texts_of(mapping.substr(colon + 2, end - colon - 1)));
    at = end + (mapping.compare(end, 3, "], ") == 0 ? 3 : 2);
  }
  return columns;
}

/// A sequence of one in-tree plugin; problems of the scene are errors.
inline std::unique_ptr<coupling::OperatorSequence> plugin_sequence(
    const char* id, const Settings& settings, std::vector<std::string> initial,
    coupling::SequenceOptions options = {}) {
  scene::Scene scene;
  scene::OperatorBlock block;
  block.use = id;
  block.name = "subject";
  for (const auto& [key, text] : settings) {
    scene::RawValue value{text, false, {}, {}, {}};
    if (text.starts_with('[')) {
      value = {"", true, texts_of(text), {}, {}};
    } else if (text.starts_with('{')) {  // {height: [a, b], value: [c, d]}
      value.columns = columns_of(text);
    }
    block.parameters.push_back({key, value});
  }
  scene.operators.push_back(block);
  scene::Problems problems;
  options.initial = std::move(initial);
  auto entries =
      coupling::load_operators(scene, {{PILEUS_BINARY_DIR "/lib/pileus/plugins"}}, problems);
  if (!problems.empty()) throw std::logic_error(problems.render());
  return std::make_unique<coupling::OperatorSequence>(std::move(entries), std::move(options));
}

/// A plugin bound to a random cloud on a mesh.
template <int D>
struct MeshRun {
  MeshRun(const mesh::Grid<D>& on, const char* id, const Settings& settings,
          std::vector<std::string> initial, NodeFunction flow,
          const coupling::SequenceOptions& options = {})
      : grid(on),
        sequence(plugin_sequence(id, settings, std::move(initial), options)),
        store(D, sequence->required_scalars()),
        mesh(grid, store, std::move(flow)) {}

  /// Random parcels, elongated `spread`-fold, `count` of them filling the domain; some with centres
  /// on the walls.
  void fill(std::size_t count, double spread, unsigned seed) {
    Random random(seed);
    fill_randomly<D>(store, grid, count, grid.domain_volume() / static_cast<double>(count), spread,
                     random);
    for (std::size_t p = 0; p < count; p += 50)
      store.position(D - 1)[p] = p % 100 == 0 ? grid.bottom() : grid.top();
  }
  void bind() {
    mesh.reorder();
    sequence->bind(store, coupling::abi_grid(grid), &mesh);
    sequence->init({});
  }
  void step(double dt, std::uint64_t number = 0) {
    sequence->apply_after_transport({number, static_cast<double>(number) * dt, dt});
  }
  double* values(const char* name) { return store.scalar(store.find_scalar(name)); }

  mesh::Grid<D> grid;
  std::unique_ptr<coupling::OperatorSequence> sequence;
  parcels::Store store;
  SampledMesh<D> mesh;
};

/// Σ V φ and Σ V |φ| over all parcels.
inline std::pair<long double, long double> amount(const parcels::Store& store, const double* x) {
  long double sum = 0, magnitude = 0;
  for (std::size_t p = 0; p < store.size(); ++p) {
    sum += static_cast<long double>(store.volume()[p]) * x[p];
    magnitude += static_cast<long double>(store.volume()[p]) * std::abs(x[p]);
  }
  return {sum, magnitude};
}

}  // namespace pileus::testing

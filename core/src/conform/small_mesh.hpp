// The mesh of a small domain for operators that read it: the core's own deposit and interpolation,
// a flow that is drawn at random.
#pragma once
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "conform/draw.hpp"
#include "coupling/mesh_access.hpp"
#include "mesh/flow_quantities.hpp"
#include "parcels/deposit.hpp"
#include "parcels/interpolate.hpp"
#include "parcels/upkeep.hpp"
#include "parcels/walls.hpp"

namespace pileus::conform {

template <int D>
class SmallMesh final : public coupling::MeshAccess {
 public:
  SmallMesh(const mesh::Grid<D>& grid, parcels::Store& store, std::uint64_t seed)
      : grid_(grid), store_(store), seed_(seed), deposit_(grid) {
    Random random(seed);
    for (double& u : mean_wind_) u = uniform(random, -10, 10);
  }

  /// Puts the parcels into cell order, which a deposit relies on.
  void reorder() {
    parcels::Upkeep<D> upkeep(grid_, deposit_.tiling(), 0, parcels::SplitCriterion<D>::never());
    parcels::SupportOffsets<D> offsets;
    PhaseTimes times;
    upkeep.reorder(store_, offsets, times);
    tile_begin_ = upkeep.tile_begin();
  }

  std::size_t nodes() const override { return grid_.nodes(); }
  int levels() const override { return grid_.levels(); }
  int record_width() const override { return parcels::interpolated_width<D>; }
  void deposit(std::span<const double* const> values, double* field) override {
    deposit_.means(store_, tile_begin_, {values.begin(), values.end()}, {}, field);
  }
  void mirror(double* field) const override { parcels::mirror_halo(grid_, field); }
  void interpolate(const double* field, std::span<double* const> values) const override {
    parcels::interpolate(store_, grid_, field, values);
  }
  void evaluate_flow() override {}
  int find_flow_quantity(std::string_view name) const override {
    if (mesh::find_flow_quantity<D>(name) < 0) return -1;
    const auto known = std::find(names_.begin(), names_.end(), name);
    if (known != names_.end()) return static_cast<int>(known - names_.begin());
    names_.emplace_back(name);
    return static_cast<int>(names_.size()) - 1;
  }
  /// A third of the nodes at rest, the others over four decades.
  void copy_flow_quantity(int which, double* field, int lane) const override {
    Random random(seed_ + 7919u * static_cast<unsigned>(which + 1));
    const bool magnitude = names_[static_cast<std::size_t>(which)] == "strain_rate_magnitude";
    for (std::size_t node = 0; node < grid_.nodes(); ++node) {
      const double u = uniform(random, 0, 1);
      const double size = u < 0.3 ? 0.0 : 0.02 * std::pow(10.0, -4 * u);
      const double sign = magnitude || random() % 2 == 0 ? 1 : -1;
      field[node * static_cast<std::size_t>(record_width()) + static_cast<std::size_t>(lane)] =
          sign * size;
    }
  }
  double* domain_value(std::string_view name) override {
    for (std::size_t d = 0; d + 1 < std::size_t{D}; ++d)
      if (name == coupling::mean_wind_names[d]) return &mean_wind_[d];
    return D == 3 && name == coupling::coriolis_parameter_name ? &coriolis_parameter_ : nullptr;
  }
  void confine() override { parcels::confine<D>(store_, grid_); }
  void blunt_shapes() override {}

 private:
  mesh::Grid<D> grid_;
  parcels::Store& store_;
  std::uint64_t seed_;
  parcels::Deposit<D> deposit_;
  std::vector<std::size_t> tile_begin_;
  mutable std::vector<std::string> names_;
  std::array<double, 2> mean_wind_{};  // m s⁻¹
  double coriolis_parameter_ = 1e-4;   // s⁻¹
};

}  // namespace pileus::conform

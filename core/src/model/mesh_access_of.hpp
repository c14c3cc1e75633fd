// The mesh of one dimension as operators use it.
#pragma once
#include <memory>
#include <vector>

#include "coupling/mesh_access.hpp"
#include "dynamics/parcel_motion.hpp"
#include "mesh/flow_quantities.hpp"
#include "mesh/grid.hpp"
#include "parcels/deposit.hpp"
#include "parcels/interpolate.hpp"
#include "parcels/store.hpp"
#include "parcels/walls.hpp"

namespace pileus::model {

template <int D>
class MeshAccessOf final : public coupling::MeshAccess {
 public:
  /// Parts of a simulation; they must outlive this. The transport may be built later, but before
  /// anything is asked for.
  struct Parts {
    const mesh::Grid<D>& grid;
    parcels::Store& store;
    const std::vector<std::size_t>& tile_begin;
    const std::unique_ptr<dynamics::ParcelMotion<D>>& transport;
    dynamics::MeanWind& wind;
    double coriolis_parameter;  // s⁻¹
  };
  explicit MeshAccessOf(const Parts& parts) : in_(parts) {}

  std::size_t nodes() const override { return in_.grid.nodes(); }
  int levels() const override { return in_.grid.levels(); }
  int record_width() const override { return parcels::interpolated_width<D>; }

  void deposit(std::span<const double* const> values, double* field) override {
    values_.assign(values.begin(), values.end());
    in_.transport->deposit().means(in_.store, in_.tile_begin, values_, {}, field);
  }
  void mirror(double* field) const override { parcels::mirror_halo(in_.grid, field); }
  void interpolate(const double* field, std::span<double* const> values) const override {
    parcels::interpolate(in_.store, in_.grid, field, values);
  }

  void evaluate_flow() override {
    in_.transport->evaluate_velocity(in_.store, in_.tile_begin, in_.wind, times_);
  }
  int find_flow_quantity(std::string_view name) const override {
    return mesh::find_flow_quantity<D>(name);
  }
  void copy_flow_quantity(int which, double* field, int lane) const override {
    mesh::copy_flow_quantity(in_.grid, in_.transport->flow(), which, field, record_width(), lane);
  }

  double* domain_value(std::string_view name) override {
    if (name == coupling::mean_wind_names[0]) return &in_.wind.velocity[0];
    if (D == 3 && name == coupling::mean_wind_names[1]) return &in_.wind.velocity[1];
    if (D == 3 && name == coupling::coriolis_parameter_name) return &in_.coriolis_parameter;
    return nullptr;
  }

  void confine() override { parcels::confine<D>(in_.store, in_.grid); }
  void blunt_shapes() override { in_.transport->blunt_shapes(in_.store); }

 private:
  Parts in_;
  PhaseTimes times_;  // not told: the run's ledger counts this as the operators' time
  std::vector<const double*> values_;
};

}  // namespace pileus::model

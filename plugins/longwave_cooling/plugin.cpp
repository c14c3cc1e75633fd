// Idealised longwave cooling of stratocumulus: a flux that follows from the liquid water of each
// column, and its convergence given to the parcels' potential temperature.
#include <pileus/air_parameters.hpp>
#include <pileus/mesh.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "radiative_flux.hpp"

namespace pileus::longwave {
namespace {

class LongwaveCooling : public Operator<LongwaveCooling> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    describe_flux(d);
    air_.describe_reference_constants(d);
    air_.describe_reference_profile(d);
    liquid_ = d.reads("mass_fraction_of_cloud_liquid_water_in_air", "1")
                  .range(0.0, 1.0)
                  .doc("absorbs and emits");
    total_water_ = d.reads("total_water_mass_fraction", "1")
                       .range(0.0, 1.0)
                       .optional()
                       .doc("where the inversion is");
    vapour_ = d.reads("specific_humidity", "1")
                  .range(0.0, 1.0)
                  .optional()
                  .doc("the same, without the liquid");
    theta_[0] = d.updates("liquid_water_potential_temperature", "K")
                    .intensive("heat")
                    .range(150.0, 2000.0)
                    .optional()
                    .doc("heated if carried");
    theta_[1] = d.updates("air_potential_temperature", "K")
                    .range(50.0, 2000.0)
                    .optional()
                    .doc("heated if carried");
    heat_ = d.budget("heat");
  }

  void configured() {
    mesh_ = Mesh(host());
    flux_ = {value(above_), value(below_), value(absorption_), value(divergence_),
             value(air_.heat_capacity)};
    thermo::Constants constants;
    constants.gravity = value(air_.gravity);
    constants.gas_constant_dry_air = value(air_.gas_constant);
    constants.heat_capacity = value(air_.heat_capacity);
    reference_.emplace(air_.reference_state([this](Param p) { return value(p); },
                                            [this](Param p) { return list(p); }, constants));
    kappa_ = constants.kappa();
  }

  void apply(const pileus_step& step, Block block) const {
    const auto parcels = static_cast<std::size_t>(block.count());
    const bool whole = block.has(total_water_);
    const bool inversion = value(divergence_) > 0 && (whole || block.has(vapour_));
    std::array<const double*, 2> gathered{block.in(liquid_), nullptr};
    if (inversion) gathered[1] = block.in(whole ? total_water_ : vapour_);
    double* field = block.scratch(mesh_.field_size()).data();
    mesh_.deposit(block.count(), {gathered.data(), inversion ? 2u : 1u}, field);
    const double given = heat_columns(step.dt, block, field, inversion, !whole);
    std::array<double*, 1> warmed{block.scratch(parcels).data()};
    mesh_.interpolate(block.count(), field, warmed);
    for (const Slot slot : theta_) {
      if (!block.has(slot)) continue;
      double* theta = block.out(slot);
      parallel_for(block.count(), [&](std::int64_t p) { theta[p] += warmed[0][p]; });
      expect_in_range(block, slot,
                      "longwave radiation takes the air beyond the temperatures that air has; take "
                      "shorter steps or a weaker flux");
      if (slot.index == theta_[0].index) block.book(heat_, given);
    }
  }

 private:
  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.longwave_cooling";
    d.op.kind = "radiation";
    d.op.version = "1.0.0";
    d.op.title = "Longwave cooling of stratocumulus";
    d.op.summary =
        "Cools cloud tops and warms cloud bases by a longwave flux that follows from the liquid "
        "water of each column.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("longwave_cooling");
    d.cites("10.1175/MWR2930.1", "Stevens et al. 2005: DYCOMS-II RF01, eq. 3");
  }

  void describe_flux(Declaration& d) {
    above_ = d.number("cloud_top_flux", "W m-2", 70.0)
                 .range(0.0, 1e4)
                 .doc("F_0, emitted at the top of a thick cloud");
    below_ = d.number("cloud_base_flux", "W m-2", 22.0)
                 .range(0.0, 1e4)
                 .doc("F_1, gained at the base of a thick cloud");
    absorption_ =
        d.number("absorption", "m2 kg-1", 85.0).range(0.0, 1e5).doc("of cloud liquid water, kappa");
    divergence_ = d.number("divergence", "s-1", 0.0)
                      .range(0.0, 1e-2)
                      .doc(
                          "of the large scale, D: cooling of the clear air above the inversion "
                          "that balances its subsidence");
    inversion_water_ = d.number("inversion_total_water", "1", 8e-3)
                           .range(0.0, 1.0)
                           .doc("total water (vapour, where it is carried alone) at the inversion");
  }

  /// Density and Exner function of the reference state.
  std::array<double, 2> air_at(double z) const {
    const thermo::ReferenceState::Point at = reference_->at(z);
    if (!(at.exner > 0))
      throw Failure("the domain reaches above the top of the reference atmosphere",
                    PILEUS_E_CONFIG);
    const double pressure = thermo::pressure_of_exner(at.exner, kappa_);
    const double density = pressure / (value(air_.gas_constant) * at.theta_v * at.exner);
    if (!(density > 0 && std::isfinite(density)))
      throw Failure(
          "the reference atmosphere has no density that a number can hold; its gas constant, heat "
          "capacity and gravity are not those of air",
          PILEUS_E_CONFIG);
    return {density, at.exner};
  }

  /// Turns the gathered water of every node into the increment of its parcels' potential
  /// temperature; returns what that adds up to, K m³.
  double heat_columns(double dt, Block block, double* field, bool with_inversion,
                      bool add_liquid) const {
    const pileus_grid& grid = *block.raw().grid;
    const Column column{grid.origin[2], grid.spacing[2],
                        static_cast<std::size_t>(grid.cells[2]) + 1};
    const std::size_t n = column.levels, width = mesh_.width();
    const auto columns = grid.cells[0] * grid.cells[1];
    const double area = grid.spacing[0] * (grid.dimension == 3 ? grid.spacing[1] : 1.0);
    std::span<double> air = block.scratch(2 * n);
    for (std::size_t k = 0; k < n; ++k) {
      const auto [density, exner] = air_at(column.height(k));
      air[k] = density;
      air[n + k] = exner;
    }
    std::span<double> work = block.scratch(static_cast<std::size_t>(columns) * (3 * n + 1));
    parallel_for(columns, [&](std::int64_t c) {
      std::span<double> mine = work.subspan(static_cast<std::size_t>(c) * (3 * n + 1), 3 * n + 1);
      const std::span<double> liquid = mine.first(n), water = mine.subspan(n, n),
                              convergence = mine.subspan(2 * n, n);
      double* record = field + (static_cast<std::size_t>(c) * mesh_.levels() + 1) * width;
      for (std::size_t k = 0; k < n; ++k) {
        liquid[k] = std::clamp(record[k * width + 1], 0.0, 1.0);  // a mass fraction
        if (with_inversion) water[k] = record[k * width + 2] + (add_liquid ? liquid[k] : 0.0);
      }
      const double z_i =
          with_inversion ? inversion_height(column, water, value(inversion_water_)) : 0.0;
      heating(column, flux_, air.first(n), liquid, z_i, air_at(z_i)[0], convergence);
      double given = 0;
      for (std::size_t k = 0; k < n; ++k) {
        const double warming =
            dt * convergence[k] / (air[k] * value(air_.heat_capacity) * air[n + k]);
        const double cell = area * column.spacing, volume = record[k * width];
        // What a node gives to its parcels is what its cell calls for, however full that is.
        const bool filled = volume > 1e-3 * cell;
        record[k * width] = filled ? warming * cell / volume : warming;
        given += record[k * width] * volume * column.depth(k) / column.spacing;
      }
      mine.back() = given;
    });
    double sum = 0;
    for (std::int64_t c = 0; c < columns; ++c)
      sum += work[static_cast<std::size_t>(c + 1) * (3 * n + 1) - 1];
    return sum;
  }

  Slot liquid_, total_water_, vapour_;
  std::array<Slot, 2> theta_;
  Budget heat_;
  Param above_, below_, absorption_, divergence_, inversion_water_;
  ReferenceParameters air_;
  Flux flux_;
  double kappa_ = 0;
  std::optional<thermo::ReferenceState> reference_;
  Mesh mesh_;
};

}  // namespace
}  // namespace pileus::longwave

PILEUS_PLUGIN(pileus::longwave::LongwaveCooling, "org.pileus.longwave_cooling", "1.0.0");

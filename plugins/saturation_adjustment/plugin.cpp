// Saturation adjustment as a closure: liquid water and buoyancy from the conserved quantities.
#include <pileus/air_parameters.hpp>
#include <pileus/plugin.hpp>

#include <optional>

#include "adjustment.hpp"

namespace pileus::saturation {
namespace {

constexpr const char* ideal = "thermodynamics == ideal";
constexpr const char* real = "thermodynamics == real";
constexpr const char* condensing = "effect.condensation == on";

/// Temperatures below this are no air the saturation formula is meant for, K.
constexpr double coldest = 100.0;
/// Below this air would be colder than that within a few kilometres of the ground, K.
constexpr double coldest_theta = 150.0;

class SaturationAdjustment : public Operator<SaturationAdjustment> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    describe_parameters(d);
    describe_quantities(d);
  }

  void configured() {
    latent_buoyancy_ = value(air_.gravity) * value(air_.latent_heat) /
                       (value(air_.heat_capacity) * value(air_.buoyancy_temperature));
    if (choice(thermodynamics_) == 1) build_reference_state();
  }

  void diagnose(const pileus_step&, Block block) const {
    if (reference_) {
      diagnose_real(block);
    } else {
      diagnose_ideal(block);
    }
  }

 private:
  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.saturation_adjustment";
    d.op.kind = "thermodynamics";
    d.op.version = "1.0.0";
    d.op.title = "Saturation adjustment";
    d.op.summary =
        "Condenses all water beyond saturation at once and returns the buoyancy that follows.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_CLOSURE;
    d.provides("condensation");
    d.provides("buoyancy");
    d.cites("10.1002/qj.3319", "Dritschel et al. 2018: moist parcel-in-cell, idealised air");
    d.cites("10.1175/1520-0493(1980)108<1046:TCOEPT>2.0.CO;2",
            "Bolton 1980: saturation vapour pressure, eq. 10");
    d.cites("10.1175/1520-0469(2003)60<1201:ALESIS>2.0.CO;2",
            "Siebesma et al. 2003: liquid-water potential temperature and constants");
  }

  void describe_parameters(Declaration& d) {
    thermodynamics_ = d.choice("thermodynamics", {"ideal", "real"})
                          .doc("saturation by height alone, or by temperature and pressure");
    air_.describe_constants(d);
    surface_humidity_ = d.number("surface_humidity", "1", 0.015)
                            .range(0.0, 1.0)
                            .when(ideal)
                            .doc("saturation specific humidity at the base height, q_0");
    scale_height_ = d.number("scale_height", "m", 1000.0)
                        .range(1e-3, 1e6)
                        .when(ideal)
                        .doc("e-folding height of the saturation humidity, H");
    air_.describe_real_air(d, real);
  }

  void describe_quantities(Declaration& d) {
    height_ = d.reads("height", "m").doc("of the parcel's centre");
    buoyancy_l_ = d.reads("liquid_water_buoyancy", "m s-2")
                      .intensive("buoyancy")
                      .range(-1e4, 1e4)
                      .when(ideal)
                      .doc("buoyancy of the parcel with all its liquid evaporated");
    theta_l_ = d.reads("liquid_water_potential_temperature", "K")
                   .intensive("heat")
                   .range(coldest_theta, 2000.0)
                   .when(real)
                   .doc("potential temperature with all liquid evaporated");
    total_water_ = d.reads("total_water_mass_fraction", "1")
                       .intensive("water")
                       .range(0.0, 1.0)
                       .doc("vapour and liquid together");
    buoyancy_ = d.derives("buoyancy", "m s-2").range(-1e6, 1e6).doc("total buoyancy");
    liquid_ = d.derives("mass_fraction_of_cloud_liquid_water_in_air", "1")
                  .range(0.0, 1.0)
                  .when(condensing)
                  .doc("liquid water");
    temperature_ = d.derives("air_temperature", "K")
                       .range(coldest, 1e4)
                       .when(real)
                       .on_demand()
                       .doc("temperature");
  }

  void build_reference_state() {
    const auto number = [this](Param p) { return value(p); };
    constants_ = air_.constants(number);
    formula_ = static_cast<thermo::SaturationFormula>(choice(air_.saturation_pressure));
    reference_.emplace(air_.reference_state(number, [this](Param p) { return list(p); }));
  }

  void diagnose_ideal(Block block) const {
    if (!block.has(liquid_)) {
      IdealAir::diagnose_unsaturated(block.count(), block.in(buoyancy_l_), block.out(buoyancy_));
      return;
    }
    const IdealAir air{value(surface_humidity_), value(air_.base_height), value(scale_height_),
                       latent_buoyancy_};
    air.diagnose(block.count(), block.in(height_), block.in(buoyancy_l_), block.in(total_water_),
                 block.out(buoyancy_), block.out(liquid_));
  }

  /// Buoyancy and temperature of all parcels; `condense` gives the equilibrium of a parcel from its
  /// position in the block, the Exner function and the liquid-water temperature.
  template <class Condense>
  void diagnose_real(Block block, Condense&& condense) const {
    const double* z = block.in(height_);
    const double* theta = block.in(theta_l_);
    const double* total = block.in(total_water_);
    double* b = block.out(buoyancy_);
    double* t = block.has(temperature_) ? block.out(temperature_) : nullptr;
    const double scale = constants_.gravity / value(air_.buoyancy_temperature);
    block.each([&](auto p) {
      const thermo::ReferenceState::Point at = reference_->at(z[p]);
      const double temperature_l = at.exner * theta[p];
      if (!(temperature_l >= coldest)) refuse_cold(block.uid(p), z[p], temperature_l);
      const Equilibrium found = condense(p, at.exner, temperature_l);
      if (t != nullptr) t[p] = found.temperature;
      const double theta_v = thermo::virtual_potential_temperature(
          found.temperature / at.exner, total[p] - found.liquid, found.liquid);
      b[p] = scale * (theta_v - at.theta_v);
    });
  }

  void diagnose_real(Block block) const {
    if (!block.has(liquid_)) {
      diagnose_real(block, [](auto, double, double temperature_l) {
        return Equilibrium{temperature_l, 0.0, 0};
      });
      return;
    }
    const double* total = block.in(total_water_);
    double* wet = block.out(liquid_);
    const double kappa = constants_.kappa();
    const double latent_over_heat = constants_.latent_heat / constants_.heat_capacity;
    diagnose_real(block, [&](auto p, double exner, double temperature_l) {
      const double pressure = thermo::pressure_of_exner(exner, kappa);
      const Equilibrium found =
          adjust(temperature_l, total[p], latent_over_heat, [&](double kelvin) {
            return thermo::saturation_specific_humidity(
                thermo::saturation_pressure(kelvin, formula_), pressure, constants_.epsilon);
          });
      wet[p] = found.liquid;
      return found;
    });
  }

  [[noreturn]] void refuse_cold(std::uint64_t uid, double z, double temperature_l) const {
    char text[200];
    std::snprintf(text, sizeof text,
                  "temperature %.6g K at height %.6g m is below %g K; the reference state does "
                  "not reach this high or the parcel's state is broken",
                  temperature_l, z, coldest);
    throw Failure(text, PILEUS_E_INPUT).at(uid, theta_l_.index, temperature_l);
  }

  Slot height_, buoyancy_l_, theta_l_, total_water_, buoyancy_, liquid_, temperature_;
  AirParameters air_;
  Param thermodynamics_, surface_humidity_, scale_height_;
  double latent_buoyancy_ = 0;  // G, m s-2
  thermo::Constants constants_;
  thermo::SaturationFormula formula_ = thermo::SaturationFormula::bolton;
  std::optional<thermo::ReferenceState> reference_;
};

}  // namespace
}  // namespace pileus::saturation

PILEUS_PLUGIN(pileus::saturation::SaturationAdjustment, "org.pileus.saturation_adjustment",
              "1.0.0");

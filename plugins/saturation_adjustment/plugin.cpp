// Saturation adjustment as a closure: liquid water and buoyancy from the conserved quantities.
#include <pileus/plugin.hpp>

#include <optional>

#include "adjustment.hpp"
#include "reference_state.hpp"

namespace pileus::saturation {
namespace {

constexpr const char* ideal = "thermodynamics == ideal";
constexpr const char* real = "thermodynamics == real";

/// Temperatures below this are no air the saturation formula is meant for, K.
constexpr double coldest = 100.0;

class SaturationAdjustment : public Operator<SaturationAdjustment> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    describe_parameters(d);
    describe_quantities(d);
  }

  void configured() {
    latent_buoyancy_ = value(gravity_) * value(latent_heat_) /
                       (value(heat_capacity_) * value(buoyancy_temperature_));
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
    gravity_ = d.number("gravity", "m s-2", 9.81).range(1e-3, 1e3).doc("acceleration of gravity");
    latent_heat_ = d.number("latent_heat", "J kg-1", 2.5e6).range(1.0, 1e9).doc("of vaporisation");
    heat_capacity_ = d.number("heat_capacity", "J kg-1 K-1", 1005.0)
                         .range(1.0, 1e6)
                         .doc("of dry air at constant pressure");
    buoyancy_temperature_ = d.number("buoyancy_temperature", "K", 300.0)
                                .range(1.0, 1e4)
                                .doc("constant temperature that scales the buoyancy, theta_00");
    base_height_ = d.number("base_height", "m", 0.0)
                       .range(-1e6, 1e6)
                       .doc("height of the surface humidity or surface pressure");
    surface_humidity_ = d.number("surface_humidity", "1", 0.015)
                            .range(0.0, 1.0)
                            .when(ideal)
                            .doc("saturation specific humidity at the base height, q_0");
    scale_height_ = d.number("scale_height", "m", 1000.0)
                        .range(1e-3, 1e6)
                        .when(ideal)
                        .doc("e-folding height of the saturation humidity, H");
    surface_pressure_ = d.number("surface_pressure", "Pa", 1.0e5)
                            .range(1e3, 2e5)
                            .when(real)
                            .doc("reference pressure at the base height");
    gas_constant_ = d.number("gas_constant_dry_air", "J kg-1 K-1", 287.04)
                        .range(1.0, 1e4)
                        .when(real)
                        .doc("of dry air");
    epsilon_ = d.number("epsilon", "1", 0.622)
                   .range(0.01, 0.99)
                   .when(real)
                   .doc("ratio of the gas constants of dry air and vapour");
    reference_height_ = d.numbers("reference_height", "m", 0.0)
                            .range(-1e6, 1e6)
                            .when(real)
                            .doc("heights of the reference profile, ascending");
    reference_theta_v_ = d.numbers("reference_potential_temperature", "K", 300.0)
                             .range(50.0, 2000.0)
                             .when(real)
                             .doc(
                                 "virtual potential temperature of the hydrostatic reference "
                                 "state at those heights; buoyancy is measured from it");
  }

  void describe_quantities(Declaration& d) {
    height_ = d.reads("height", "m").doc("of the parcel's centre");
    buoyancy_l_ = d.reads("liquid_water_buoyancy", "m s-2")
                      .intensive()
                      .range(-1e4, 1e4)
                      .when(ideal)
                      .doc("buoyancy of the parcel with all its liquid evaporated");
    theta_l_ = d.reads("liquid_water_potential_temperature", "K")
                   .intensive()
                   .range(50.0, 2000.0)
                   .when(real)
                   .doc("potential temperature with all liquid evaporated");
    total_water_ = d.reads("total_water_mass_fraction", "1")
                       .intensive("water")
                       .range(0.0, 1.0)
                       .doc("vapour and liquid together");
    buoyancy_ = d.derives("buoyancy", "m s-2").range(-1e6, 1e6).doc("total buoyancy");
    liquid_ = d.derives("mass_fraction_of_cloud_liquid_water_in_air", "1")
                  .range(0.0, 1.0)
                  .doc("liquid water");
    temperature_ =
        d.derives("air_temperature", "K").range(coldest, 1e4).when(real).doc("temperature");
  }

  void build_reference_state() {
    constants_ = {value(gravity_), value(gas_constant_), value(heat_capacity_), value(latent_heat_),
                  value(epsilon_)};
    const auto heights = list(reference_height_), theta_v = list(reference_theta_v_);
    if (heights.size() != theta_v.size()) {
      throw Failure(
          "reference_height and reference_potential_temperature differ in their number of "
          "values; give one temperature for each height",
          PILEUS_E_CONFIG);
    }
    for (std::size_t i = 1; i < heights.size(); ++i) {
      if (!(heights[i] > heights[i - 1])) {
        throw Failure("reference_height does not ascend; order the heights from low to high",
                      PILEUS_E_CONFIG);
      }
    }
    reference_.emplace(heights, theta_v, value(base_height_), value(surface_pressure_), constants_);
  }

  void diagnose_ideal(Block block) const {
    const IdealAir air{value(surface_humidity_), value(base_height_), value(scale_height_),
                       latent_buoyancy_};
    air.diagnose(block.count(), block.in(height_), block.in(buoyancy_l_), block.in(total_water_),
                 block.out(buoyancy_), block.out(liquid_));
  }

  void diagnose_real(Block block) const {
    const double* z = block.in(height_);
    const double* theta = block.in(theta_l_);
    const double* total = block.in(total_water_);
    double* b = block.out(buoyancy_);
    double* wet = block.out(liquid_);
    double* t = block.out(temperature_);
    const double kappa = constants_.kappa();
    const double latent_over_heat = constants_.latent_heat / constants_.heat_capacity;
    const double scale = constants_.gravity / value(buoyancy_temperature_);
    block.each([&](auto p) {
      const ReferenceState::Point at = reference_->at(z[p]);
      const double temperature_l = at.exner * theta[p];
      if (!(temperature_l >= coldest)) refuse_cold(block.uid(p), z[p], temperature_l);
      const double pressure = thermo::pressure_of_exner(at.exner, kappa);
      const Equilibrium found =
          adjust(temperature_l, total[p], latent_over_heat, [&](double kelvin) {
            return thermo::saturation_specific_humidity(thermo::saturation_pressure(kelvin),
                                                        pressure, constants_.epsilon);
          });
      wet[p] = found.liquid;
      t[p] = found.temperature;
      const double theta_v = thermo::virtual_potential_temperature(
          found.temperature / at.exner, total[p] - found.liquid, found.liquid);
      b[p] = scale * (theta_v - at.theta_v);
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
  Param thermodynamics_, gravity_, latent_heat_, heat_capacity_, buoyancy_temperature_,
      base_height_;
  Param surface_humidity_, scale_height_;
  Param surface_pressure_, gas_constant_, epsilon_, reference_height_, reference_theta_v_;
  double latent_buoyancy_ = 0;  // G, m s-2
  thermo::Constants constants_;
  std::optional<ReferenceState> reference_;
};

}  // namespace
}  // namespace pileus::saturation

PILEUS_PLUGIN(pileus::saturation::SaturationAdjustment, "org.pileus.saturation_adjustment",
              "1.0.0");

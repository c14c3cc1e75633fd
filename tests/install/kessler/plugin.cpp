// Kessler's warm rain on parcels: vapour, cloud and rain, each a mass fraction. README.md has the
// equations.
#include <pileus/air_parameters.hpp>
#include <pileus/moist_air.hpp>
#include <pileus/plugin.hpp>

#include <optional>

#include "adjustment.hpp"
#include "rates.hpp"

namespace kessler {
namespace {

using pileus::Block;
using pileus::Declaration;
using pileus::Slot;

constexpr const char* condensing = "effect.condensation == on";
constexpr const char* raining = "effect.warm_rain == on";
constexpr double coldest_theta = 50.0, warmest_theta = 2000.0;  // K

class Kessler : public pileus::Operator<Kessler> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    describe_parameters(d);
    describe_quantities(d);
    describe_activity(d);
  }

  void configured() {
    const auto number = [this](pileus::Param p) { return value(p); };
    air_.constants = parameters_.constants(number);
    air_.formula =
        static_cast<pileus::thermo::SaturationFormula>(choice(parameters_.saturation_pressure));
    reference_.emplace(
        parameters_.reference_state(number, [this](pileus::Param p) { return list(p); }));
  }

  void diagnose(const pileus_step&, Block block) const {
    const double* z = block.in(height_);
    const double* theta = block.in(theta_);
    const double* vapour = block.in(vapour_);
    const double* cloud = block.has(cloud_) ? block.in(cloud_) : nullptr;
    const double* rain = block.has(rain_) ? block.in(rain_) : nullptr;
    double* humidity = block.has(humidity_) ? block.out(humidity_) : nullptr;
    double* b = block.out(buoyancy_);
    const double scale = air_.constants.gravity / value(parameters_.buoyancy_temperature);
    block.each([&](auto p) {
      const pileus::thermo::ReferenceState::Point at = reference_->at(z[p]);
      const double temperature = at.exner * theta[p];
      if (!(temperature >= pileus::coldest_air)) {
        refuse(block.uid(p),
               "the air is colder than 100 K; the reference state does not reach this high or the "
               "parcel's state is broken",
               temperature);
      }
      if (humidity != nullptr)
        humidity[p] = air_.relative_humidity(vapour[p], temperature, pressure(at.exner));
      const double liquid = (cloud != nullptr ? cloud[p] : 0.0) + (rain != nullptr ? rain[p] : 0.0);
      b[p] = scale * (pileus::thermo::virtual_potential_temperature(theta[p], vapour[p], liquid) -
                      at.theta_v);
    });
  }

  void apply(const pileus_step& step, Block block) const {
    if (!block.has(cloud_)) return;
    const double* z = block.in(height_);
    const double* humidity = block.in(humidity_);
    double* theta = block.out(theta_);
    double* vapour = block.out(vapour_);
    double* cloud = block.out(cloud_);
    double* rain = block.has(rain_) ? block.out(rain_) : nullptr;
    double* drops = rain != nullptr ? block.out(drops_) : nullptr;
    block.each([&](auto p) {
      const bool rainy = rain != nullptr && (rain[p] > 0 || drops[p] > 0);
      // The activity condition again, so that skipping changes nothing.
      if (!(humidity[p] > 1 || cloud[p] > 0 || rainy) || step.dt == 0) return;
      const double exner = reference_->at(z[p]).exner;
      Air parcel{exner * theta[p], pressure(exner), vapour[p], cloud[p],
                 rain != nullptr ? rain[p] : 0.0};
      advance(parcel, rain != nullptr, step.dt);
      const double warmer = theta[p] + parcel.warming / exner;
      if (!(warmer >= coldest_theta && warmer <= warmest_theta))
        refuse(block.uid(p), "phase changes take the air beyond all temperatures of air", warmer);
      theta[p] = warmer;
      vapour[p] = parcel.vapour;
      cloud[p] = parcel.cloud;
      if (rain == nullptr) return;
      rain[p] = parcel.rain;
      drops[p] =
          raindrops(rain[p], air_.density(parcel.temperature, parcel.pressure), value(intercept_));
    });
    if (drops != nullptr)
      expect_in_range(block, drops_,
                      "there are more drops than any air has; look at the pressure of the "
                      "reference state and at the intercept");
  }

 private:
  struct Air {
    double temperature, pressure, vapour, cloud, rain;
    double warming = 0;  // of the step, K

    void condense(double amount, double warming_per_amount) {
      vapour -= amount;
      temperature += warming_per_amount * amount;
      warming += warming_per_amount * amount;
    }
  };

  /// Collection, then saturation adjustment, then evaporation of rain into what is still below
  /// saturation: the order of KW, in which cloud evaporates before rain does.
  void advance(Air& a, bool with_rain, double dt) const {
    if (with_rain) {
      const double amount = collected(a.cloud, a.rain, value(threshold_), value(autoconversion_),
                                      value(accretion_), dt);
      a.rain += amount;
      a.cloud -= amount;
    }
    const double condensed = condensation(air_, a.temperature, a.pressure, a.vapour, a.cloud);
    a.condense(condensed, air_.warming());
    a.cloud = std::max(0.0, a.cloud + condensed);
    if (!with_rain || !(a.rain > 0)) return;
    const pileus::Saturation s = air_.saturation(a.temperature, a.pressure);
    const double rate =
        evaporation_rate(a.rain, s.humidity, air_.density(a.temperature, a.pressure), a.pressure);
    const double gone =
        evaporated(a.rain, s.humidity - a.vapour, rate, 1.0 + air_.warming() * s.slope, dt);
    a.condense(-gone, air_.warming());
    a.rain -= gone;
  }

  double pressure(double exner) const {
    return pileus::thermo::pressure_of_exner(exner, air_.constants.kappa());
  }

  [[noreturn]] void refuse(std::uint64_t uid, const char* why, double kelvin) const {
    throw pileus::Failure(why, PILEUS_E_INPUT).at(uid, theta_.index, kelvin);
  }

  static void describe_operator(Declaration& d) {
    d.op.id = "org.example.kessler";
    d.op.kind = "microphysics";
    d.op.version = "1.0.0";
    d.op.title = "Kessler's warm rain";
    d.op.summary =
        "Condenses all vapour beyond saturation, turns cloud into rain and evaporates rain below "
        "saturation.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.provides("condensation");
    d.provides("buoyancy");
    d.provides("warm_rain");
    d.cites("10.1007/978-1-935704-36-2_1", "Kessler 1969");
    d.cites("10.1175/1520-0469(1978)035<1070:TSOTDC>2.0.CO;2", "Klemp & Wilhelmson 1978");
    d.cites("10.1175/1520-0469(1973)030<0879:ACBAAS>2.0.CO;2", "Soong & Ogura 1973: adjustment");
  }

  void describe_parameters(Declaration& d) {
    parameters_.describe_constants(d);
    parameters_.describe_real_air(d);
    threshold_ = d.number("autoconversion_threshold", "1", 1e-3)
                     .range(0.0, 1.0)
                     .doc("cloud that stays cloud, a");
    autoconversion_ =
        d.number("autoconversion_rate", "s-1", 1e-3).range(0.0, 1.0).doc("of cloud beyond it, k1");
    accretion_ = d.number("accretion_coefficient", "s-1", 2.2).range(0.0, 100.0).doc("k2");
    intercept_ = d.number("intercept", "m-4", 8e6)
                     .range(1e3, 1e12)
                     .doc("of the distribution of drops, N_0, which gives their number");
  }

  void describe_quantities(Declaration& d) {
    d.budget("water");
    height_ = d.reads("height", "m").doc("of the parcel's centre");
    theta_ =
        d.updates("air_potential_temperature", "K").intensive().range(coldest_theta, warmest_theta);
    vapour_ = d.updates("specific_humidity", "1").intensive("water").range(0.0, 1.0);
    cloud_ = d.owns("mass_fraction_of_cloud_liquid_water_in_air", "1")
                 .intensive("water")
                 .range(0.0, 1.0)
                 .when(condensing);
    rain_ = d.owns("mass_fraction_of_rain_in_air", "1")
                .intensive("water")
                .range(0.0, 1.0)
                .when(raining);
    drops_ = d.owns("number_of_raindrops_per_mass_of_air", "kg-1")
                 .intensive()
                 .range(0.0, 1e16)
                 .when(raining)
                 .doc("follows from the rain; for operators that let it fall");
    humidity_ = d.derives("relative_humidity", "1")
                    .range(0.0, std::numeric_limits<double>::max())
                    .when(condensing)
                    .on_demand();
    buoyancy_ = d.derives("buoyancy", "m s-2").range(-1e6, 1e6).doc("loading included");
  }

  /// Clear air at or below saturation stays as it is.
  static void describe_activity(Declaration& d) {
    d.active_if(0, "relative_humidity", PILEUS_GT, 1.0);
    d.active_if(1, "mass_fraction_of_cloud_liquid_water_in_air", PILEUS_GT, 0.0);
    d.active_if(2, "mass_fraction_of_rain_in_air", PILEUS_GT, 0.0);
    d.active_if(3, "number_of_raindrops_per_mass_of_air", PILEUS_GT, 0.0);
  }

  pileus::AirParameters parameters_;
  pileus::Param threshold_, autoconversion_, accretion_, intercept_;
  Slot height_, theta_, vapour_, cloud_, rain_, drops_, humidity_, buoyancy_;
  pileus::MoistAir air_;
  std::optional<pileus::thermo::ReferenceState> reference_;
};

}  // namespace
}  // namespace kessler

PILEUS_PLUGIN(kessler::Kessler, "org.example.kessler", "1.0.0");

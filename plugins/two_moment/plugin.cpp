// Two-moment clouds: mass and number of droplets and drops, supersaturation that is never assumed.
#include <pileus/plugin.hpp>

#include <algorithm>
#include <optional>

#include "collection.hpp"
#include "condensation.hpp"
#include "parameters.hpp"

namespace pileus::two_moment {
namespace {

class TwoMoment : public Operator<TwoMoment> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    parameters_.describe(d);
    describe_inputs(d);
    describe_state(d);
    describe_activity(d);
  }

  void configured() {
    const Getter get{*this};
    air_ = parameters_.moist_air(get);
    aerosol_.emplace(parameters_.nuclei(get, air_.vapour_gas_constant()));
    condensation_.emplace(air_, *aerosol_, parameters_.condensation(get));
    reference_.emplace(parameters_.air.reference_state([this](Param p) { return value(p); },
                                                       [this](Param p) { return list(p); }));
    kappa_ = air_.constants.kappa();
    buoyancy_scale_ = air_.constants.gravity / value(parameters_.air.buoyancy_temperature);
    derives_buoyancy_ = choice(parameters_.buoyancy) == 0;
    collection_ = static_cast<Collection>(choice(parameters_.collection));
    const auto profile = list(parameters_.profile_theta);
    if (air_.prescribed_temperature &&
        profile.size() != list(parameters_.air.reference_height).size()) {
      throw Failure(
          "profile_potential_temperature and reference_height differ in their number of values; "
          "give one temperature for each height",
          PILEUS_E_CONFIG);
    }
  }

  void diagnose(const pileus_step&, Block block) const {
    const double* z = block.in(height_);
    const double* theta = block.in(theta_);
    const double* vapour = block.in(vapour_);
    const auto if_there = [&](Slot s) { return block.has(s) ? block.in(s) : nullptr; };
    const double* cloud = if_there(cloud_);
    const double* rain = if_there(rain_);
    const double* previous = if_there(previous_height_);
    double* kelvin = block.has(temperature_) ? block.out(temperature_) : nullptr;
    double* humidity = block.has(relative_humidity_) ? block.out(relative_humidity_) : nullptr;
    double* b = derives_buoyancy_ ? block.out(buoyancy_) : nullptr;
    block.each([&](auto p) {
      const thermo::ReferenceState::Point at = reference_->at(z[p]);
      const double t =
          air_.prescribed_temperature ? at.exner * profile_theta(z[p]) : at.exner * theta[p];
      if (!(t >= coldest_air)) refuse_cold(block.uid(p), z[p], t);
      if (kelvin != nullptr) kelvin[p] = t;
      const bool cloudy = cloud != nullptr && cloud[p] > 0;
      const bool needs_pressure = cloudy || (humidity != nullptr && vapour[p] != 0);
      const double pressure = needs_pressure ? thermo::pressure_of_exner(at.exner, kappa_) : 0.0;
      if (humidity != nullptr)
        humidity[p] = vapour[p] == 0 ? 0.0 : air_.relative_humidity(vapour[p], t, pressure);
      if (b == nullptr) return;
      double condensed = 0;
      if (cloudy && z[p] != previous[p]) {
        condensed =
            std::clamp(air_.condensed_on_the_way(z[p] - previous[p], theta[p], t, pressure, at),
                       -cloud[p], vapour[p]);
      }
      const double liquid =
          (cloud != nullptr ? cloud[p] : 0.0) + (rain != nullptr ? rain[p] : 0.0) + condensed;
      b[p] = buoyancy_scale_ *
             (thermo::virtual_potential_temperature((t + air_.warming() * condensed) / at.exner,
                                                    vapour[p] - condensed, liquid) -
              at.theta_v);
    });
  }

  /// Without condensation there is nothing to advance; with it, rain only where there is
  /// collection.
  void apply(const pileus_step& step, Block block) const {
    if (!block.has(cloud_)) return;
    Columns c = columns(block);
    std::uint64_t repairs = 0;
    double created = 0;
    block.each([&](auto p) {
      if (c.idle(p)) return;  // the activity condition, so that skipping changes nothing
      const Actions did = advance(c, p, step.dt);
      if (c.peak != nullptr) c.peak[p] = std::max(c.peak[p], did.peak);
      repairs += static_cast<std::uint64_t>(did.limited + did.repaired);
      created += c.volume[p] * did.created;
    });
    expect_in_range(block, theta_,
                    "condensation takes the air beyond all temperatures of air; look at the latent "
                    "heat, the heat capacity and the parcel's state");
    for (const Slot slot : {droplets_, aerosol_number_, raindrops_})
      if (block.has(slot))
        expect_in_range(block, slot,
                        "there are more particles than any air has; look at the aerosol's number "
                        "and at the numbers that the parcels began with");
    block.book(number_budget_, created);
    block.repaired(repairs);
  }

 private:
  /// The accessors of the operator in the form that Parameters takes.
  struct Getter {
    const TwoMoment& op;
    double number(Param p) const { return op.value(p); }
    int choice(Param p) const { return op.choice(p); }
    std::span<const double> list(Param p) const { return op.list(p); }
  };

  /// The columns of one block; those of quantities that do not exist are null.
  struct Columns {
    const double *height, *humidity, *volume;
    double *previous, *theta, *vapour, *cloud, *droplets, *aerosol, *rain, *raindrops, *peak;

    bool idle(std::int64_t p) const {
      return humidity[p] <= 1 && cloud[p] <= 0 && droplets[p] <= 0 &&
             (rain == nullptr || (rain[p] <= 0 && raindrops[p] <= 0));
    }
    Water load(std::int64_t p) const {
      Water w;
      w.theta = theta[p];
      w.vapour = vapour[p];
      w.cloud = cloud[p];
      w.droplets = droplets[p];
      if (aerosol != nullptr) w.aerosol = aerosol[p];
      if (rain != nullptr) w.rain = rain[p], w.raindrops = raindrops[p];
      return w;
    }
    void store(std::int64_t p, const Water& w) const {
      theta[p] = w.theta;
      vapour[p] = w.vapour;
      cloud[p] = w.cloud;
      droplets[p] = w.droplets;
      if (aerosol != nullptr) aerosol[p] = w.aerosol;
      if (rain != nullptr) rain[p] = w.rain, raindrops[p] = w.raindrops;
    }
  };

  Columns columns(const Block& block) const {
    const auto if_there = [&](Slot s) { return block.has(s) ? block.out(s) : nullptr; };
    return {block.in(height_),         block.in(relative_humidity_),
            block.in(volume_),         block.out(previous_height_),
            block.out(theta_),         block.out(vapour_),
            block.out(cloud_),         block.out(droplets_),
            if_there(aerosol_number_), if_there(rain_),
            if_there(raindrops_),      if_there(peak_)};
  }

  Level level(double height) const {
    const double exner = reference_->at(height).exner;
    return {thermo::pressure_of_exner(exner, kappa_), exner,
            air_.prescribed_temperature ? exner * profile_theta(height) : 0.0};
  }

  Actions advance(const Columns& c, std::int64_t p, double dt) const {
    Water water = c.load(p);
    const Level to = level(c.height[p]);
    const Level from = c.previous[p] == c.height[p] ? to : level(c.previous[p]);
    Actions did = condensation_->advance(water, from, to, dt);
    if (c.rain != nullptr) {
      const double density = air_.density(air_.temperature(water.theta, to), to.pressure);
      if (collection_ == Collection::khairoutdinov_kogan) {
        collect(KhairoutdinovKogan{}, water, density, dt, did);
      } else {
        collect(SeifertBeheng{}, water, density, dt, did);
      }
      condensation_->keep_sizes(water, did);
    }
    c.store(p, water);
    c.previous[p] = c.height[p];  // this ascent has been accounted for
    return did;
  }

  /// Potential temperature of the prescribed profile, linear between its heights.
  double profile_theta(double height) const {
    const auto heights = list(parameters_.air.reference_height);
    const auto theta = list(parameters_.profile_theta);
    if (!(height > heights.front())) return theta.front();
    std::size_t i = heights.size() - 1;
    while (height < heights[i]) --i;
    if (i + 1 == heights.size()) return theta.back();
    const double share = (height - heights[i]) / (heights[i + 1] - heights[i]);
    return theta[i] + share * (theta[i + 1] - theta[i]);
  }

  [[noreturn]] void refuse_cold(std::uint64_t uid, double z, double t) const {
    char text[200];
    std::snprintf(text, sizeof text,
                  "temperature %.6g K at height %.6g m is below %g K; the reference state does "
                  "not reach this high or the parcel's state is broken",
                  t, z, coldest_air);
    throw Failure(text, PILEUS_E_INPUT).at(uid, theta_.index, t);
  }

  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.two_moment";
    d.op.kind = "microphysics";
    d.op.version = "1.0.0";
    d.op.title = "Two-moment clouds with prognostic supersaturation";
    d.op.summary =
        "Activates, grows and evaporates droplets by the supersaturation a parcel meets, and "
        "collects them into rain.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.flags = PILEUS_STIFF;
    d.provides("condensation");
    d.provides("activation");
    d.provides("buoyancy", with_derived_buoyancy);
    d.provides("collection", with_rain);
    d.provides("rain_evaporation", with_rain);
    d.cites("10.1175/2007JAS2374.1",
            "Morrison & Grabowski 2008: relaxation of supersaturation over a step");
    d.cites("10.1029/1999JD901161", "Abdul-Razzak & Ghan 2000: activation");
    d.cites("10.1175/1520-0493(2000)128<0229:ANCPPI>2.0.CO;2",
            "Khairoutdinov & Kogan 2000: collection");
    d.cites("10.1007/s00703-005-0112-4", "Seifert & Beheng 2006: collection");
  }

  void describe_inputs(Declaration& d) {
    height_ = d.reads("height", "m").doc("of the parcel's centre");
    volume_ = d.reads("parcel_volume", "m3").doc("weights the ledger's numbers");
    previous_height_ = d.updates("previous_height", "m")
                           .intensive()
                           .when(condensing)
                           .doc("where the parcel was when its supersaturation was last advanced");
    theta_ = d.updates("air_potential_temperature", "K").intensive().range(50.0, 2000.0);
    vapour_ = d.updates("specific_humidity", "1").intensive("water").range(0.0, 1.0);
    aerosol_number_ = d.updates("number_of_aerosol_particles_per_mass_of_air", "kg-1")
                          .intensive("droplets_and_aerosol")
                          .range(0.0, 1e16)
                          .when(with_carried_aerosol)
                          .doc("not yet activated");
  }

  void describe_state(Declaration& d) {
    number_budget_ = d.budget("droplets_and_aerosol");
    d.budget("water");
    cloud_ = d.owns("mass_fraction_of_cloud_liquid_water_in_air", "1")
                 .intensive("water")
                 .range(0.0, 1.0)
                 .when(condensing);
    droplets_ = d.owns("number_of_cloud_droplets_per_mass_of_air", "kg-1")
                    .intensive("droplets_and_aerosol")
                    .range(0.0, 1e16)
                    .when(condensing);
    rain_ = d.owns("mass_fraction_of_rain_in_air", "1")
                .intensive("water")
                .range(0.0, 1.0)
                .when(collecting);
    raindrops_ = d.owns("number_of_raindrops_per_mass_of_air", "kg-1")
                     .intensive()
                     .range(0.0, 1e16)
                     .when(collecting);
    peak_ = d.owns("largest_supersaturation", "1")
                .intensive()
                .range(0.0, 1e300)
                .when(with_peak)
                .doc("met since the start while droplets could form");
    temperature_ = d.derives("air_temperature", "K").range(coldest_air, 1e4).on_demand();
    relative_humidity_ = d.derives("relative_humidity", "1")
                             .range(0.0, std::numeric_limits<double>::max())
                             .when(condensing)
                             .on_demand()
                             .doc("over liquid water; above 1 droplets are activated");
    buoyancy_ = d.derives("buoyancy", "m s-2")
                    .range(-1e6, 1e6)
                    .when(with_derived_buoyancy)
                    .doc("total buoyancy, loading included");
  }

  /// Air without drops below saturation is left alone: nothing of it is remembered.
  static void describe_activity(Declaration& d) {
    d.active_if(0, "relative_humidity", PILEUS_GT, 1.0);
    d.active_if(1, "mass_fraction_of_cloud_liquid_water_in_air", PILEUS_GT, 0.0);
    d.active_if(2, "number_of_cloud_droplets_per_mass_of_air", PILEUS_GT, 0.0);
    d.active_if(3, "mass_fraction_of_rain_in_air", PILEUS_GT, 0.0);
    d.active_if(4, "number_of_raindrops_per_mass_of_air", PILEUS_GT, 0.0);
  }

  Parameters parameters_;
  Slot height_, volume_, previous_height_, theta_, vapour_, aerosol_number_;
  Slot cloud_, droplets_, rain_, raindrops_, peak_, temperature_, relative_humidity_, buoyancy_;
  Budget number_budget_;
  MoistAir air_;
  std::optional<Aerosol> aerosol_;
  std::optional<Condensation> condensation_;
  std::optional<thermo::ReferenceState> reference_;
  double kappa_ = 0, buoyancy_scale_ = 0;
  bool derives_buoyancy_ = true;
  Collection collection_ = Collection::none;
};

}  // namespace
}  // namespace pileus::two_moment

PILEUS_PLUGIN(pileus::two_moment::TwoMoment, "org.pileus.two_moment", "1.0.0");

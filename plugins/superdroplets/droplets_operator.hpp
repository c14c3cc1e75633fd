// The operator that owns the superdroplets: makes them, lets them grow and evaporate, and derives
// from them what the parcels show.
#pragma once
#include <pileus/plugin.hpp>

#include <algorithm>
#include <optional>
#include <vector>

#include "parameters.hpp"
#include "ventilated_drops.hpp"

namespace pileus::superdroplets {

class DropletsOperator : public Operator<DropletsOperator> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    parameters_.describe(d);
    describe_air(d);
    describe_droplets(d);
    describe_derived(d);
    d.active_if(0, multiplicity_name, PILEUS_GT, 0.0);
  }

  void configured() {
    const Getter get{*this};
    air_ = parameters_.droplet_air(get);
    condensation_.emplace(air_, parameters_.options(get));
    sampler_.emplace(parameters_.sampler(get));
    density_ = value(parameters_.density);
    items_ = {sizeof items_, 0, parameters_.most_per_parcel(get), density_};
    in_air_ = choice(parameters_.thermodynamics) == 0;
    if (in_air_)
      reference_.emplace(parameters_.air.reference_state([this](Param p) { return value(p); },
                                                         [this](Param p) { return list(p); }));
    kappa_ = air_.air.constants.kappa();
    buoyancy_scale_ = air_.air.constants.gravity / value(parameters_.air.buoyancy_temperature);
    const double r = value(parameters_.rain_radius);
    rain_mass_ = drops::mass_of_radius(r);
  }

  const void* extension(const char* id) const {
    return std::strcmp(id, PILEUS_ITEMS_EXTENSION) == 0 ? &items_ : nullptr;
  }

  void init(const pileus_step& step, Block block) {
    const auto parcels = static_cast<std::size_t>(block.count());
    const std::size_t each = sampler_->count();
    std::vector<Superdroplet> made(parcels * each);
    std::vector<std::int32_t> count(parcels);
    const double* volume = block.in(volume_);
    refuse_uncountable(block);
    parallel_for(block.count(), [&](std::int64_t p) {
      const auto at = static_cast<std::size_t>(p);
      const Uniforms draws(step, block.uid(p), sampler_->uniforms());
      count[at] = static_cast<std::int32_t>(
          sampler_->sample(density_ * volume[p], humidity_of(block, p), draws,
                           std::span(made).subspan(at * each, each)));
    });
    std::size_t total = 0;
    for (const std::int32_t n : count) total += static_cast<std::size_t>(n);
    regroup_items(block, count, std::vector<std::int64_t>(total, -1));
    const Columns items(*this, block);
    parallel_for(block.count(), [&](std::int64_t p) {
      const Superdroplet* from = made.data() + static_cast<std::size_t>(p) * each;
      for (std::int64_t i = block.item_begin(p); i < block.item_end(p); ++i, ++from) {
        items.multiplicity[i] = from->multiplicity;
        items.water[i] = from->water_mass;
        if (items.dry == nullptr) continue;
        items.dry[i] = from->dry_volume;
        items.hygroscopic[i] = from->hygroscopic_volume;
      }
    });
  }

  void diagnose(const pileus_step&, Block block) const {
    const auto room = [&](Slot s) { return block.has(s) ? block.out(s) : nullptr; };
    const Derived out{room(temperature_), room(relative_humidity_), room(buoyancy_), room(cloud_),
                      room(rain_),        room(droplets_)};
    const std::int64_t* multiplicity =
        block.has(multiplicity_) ? block.whole_in(multiplicity_) : nullptr;
    const double* water = multiplicity != nullptr ? block.in(water_) : nullptr;
    const double* volume = block.in(volume_);
    block.each([&](auto p) {
      Liquid liquid;
      if (multiplicity != nullptr) liquid = sum_up(block, p, multiplicity, water);
      const double per_mass = 1.0 / (density_ * volume[p]);
      liquid.cloud *= per_mass;
      liquid.rain *= per_mass;
      if (out.cloud != nullptr) out.cloud[p] = liquid.cloud;
      if (out.rain != nullptr) out.rain[p] = liquid.rain;
      const double kelvin = in_air_ ? diagnose_air(block, p, liquid, out) : 0.0;
      if (out.droplets != nullptr)
        out.droplets[p] = per_mass * count_activated(block, p, multiplicity, water, kelvin);
    });
  }

  void apply(const pileus_step& step, Block block) const {
    if (!block.has(previous_height_)) return;  // no condensation
    const Columns items(*this, block);
    const double *z = block.in(height_), *volume = block.in(volume_);
    double *previous = block.out(previous_height_), *theta = block.out(theta_);
    double *vapour = block.out(vapour_), *peak = block.has(peak_) ? block.out(peak_) : nullptr;
    std::size_t longest = 0;
    block.each([&](auto p) {
      longest =
          std::max(longest, static_cast<std::size_t>(block.item_end(p) - block.item_begin(p)));
    });
    constexpr std::size_t per_droplet = Condensation::scratch_per_droplet;
    longest = std::max<std::size_t>(1, longest);
    const std::span<double> room = block.scratch((per_droplet + 2) * longest);
    const std::span<double> factors = room.subspan(per_droplet * longest, longest);
    const std::span<double> nothing = room.subspan((per_droplet + 1) * longest);
    std::fill(nothing.begin(), nothing.end(), 0.0);
    block.each([&](auto p) {
      const auto first = static_cast<std::size_t>(block.item_begin(p));
      const auto n = static_cast<std::size_t>(block.item_end(p)) - first;
      const std::int64_t* multiplicity = items.multiplicity + first;
      // The activity condition, so that skipping changes nothing.
      if (std::none_of(multiplicity, multiplicity + n, [](std::int64_t m) { return m > 0; }))
        return;
      const Level to = level(z[p]);
      const Level from = previous[p] == z[p] ? to : level(previous[p]);
      const auto of = [&](double* column) {  // drops of pure water have no particle
        return column != nullptr ? std::span<double>(column + first, n) : nothing.first(n);
      };
      Droplets droplets{
          of(items.water), {multiplicity, n}, of(items.dry), of(items.hygroscopic), {}};
      Air air{theta[p], vapour[p]};
      if (is_on(parameters_.ventilation))
        droplets.ventilation = drops_.factors(droplets, air_.temperature(air.theta, to),
                                              to.pressure, air_.air.constants, factors);
      const Outcome did = condensation_->advance(air, droplets, density_ * volume[p], from, to,
                                                 step.dt, room.first(per_droplet * n));
      theta[p] = air.theta;
      vapour[p] = air.vapour;
      previous[p] = z[p];  // this ascent has been accounted for
      if (peak != nullptr) peak[p] = std::max(peak[p], did.largest_supersaturation);
    });
    expect_in_range(block, theta_,
                    "condensation takes the air beyond all temperatures of air; look at the latent "
                    "heat, the heat capacity and the parcel's state");
  }

 private:
  /// The accessors of the operator in the form that Parameters takes.
  struct Getter {
    const DropletsOperator& op;
    double number(Param p) const { return op.value(p); }
    int choice(Param p) const { return op.choice(p); }
    std::span<const double> list(Param p) const { return op.list(p); }
  };

  /// The droplets of one block; those quantities that do not exist are null.
  struct Columns {
    Columns(const DropletsOperator& op, const Block& block)
        : multiplicity(block.whole_out(op.multiplicity_)),
          water(block.out(op.water_)),
          dry(block.has(op.dry_) ? block.out(op.dry_) : nullptr),
          hygroscopic(block.has(op.hygroscopic_) ? block.out(op.hygroscopic_) : nullptr) {}
    std::int64_t* multiplicity;
    double *water, *dry, *hygroscopic;
  };

  struct Derived {
    double *temperature, *humidity, *buoyancy, *cloud, *rain, *droplets;
  };
  struct Liquid {
    double cloud = 0, rain = 0;  // kg, later kg kg-1
  };

  /// Draws of one parcel, more than one channel holds.
  class Uniforms {
   public:
    Uniforms(const pileus_step& step, std::uint64_t uid, std::size_t count) : draws_(count) {
      for (std::size_t from = 0; from < count; from += per_channel) {
        const auto channel = static_cast<std::uint32_t>(from / per_channel);
        const auto n = static_cast<std::uint32_t>(std::min(per_channel, count - from));
        draw(step, uid, channel, n, draws_.data() + from);
      }
    }
    double operator()(std::size_t k) const { return draws_[k]; }

   private:
    static constexpr std::size_t per_channel = 65536;
    std::vector<double> draws_;
  };

  /// Multiplicities are whole numbers of 63 bits.
  void refuse_uncountable(const Block& block) const {
    const double* volume = block.in(volume_);
    const double number = sampler_->number();
    for (std::int64_t p = 0; p < block.count(); ++p) {
      if (number * density_ * volume[p] < largest_multiplicity) continue;
      char text[200];
      std::snprintf(
          text, sizeof text,
          "a parcel of %.4g m3 has %.4g particles, more than can be counted (%.0e); lower "
          "aerosol_number or drop_number",
          volume[p], number * density_ * volume[p], largest_multiplicity);
      throw Failure(text, PILEUS_E_CONFIG);
    }
  }

  Humidity humidity_of(const Block& block, std::int64_t p) const {
    Humidity humidity{0.0, 0.0, value(parameters_.initial_humidity)};
    if (!in_air_) return humidity;
    const Level at = level(block.in(height_)[p]);
    const double t = air_.temperature(block.in(theta_)[p], at);
    humidity.saturation = air_.saturation_ratio(block.in(vapour_)[p], t, at.pressure).value;
    humidity.kelvin = air_.kelvin(t);
    return humidity;
  }

  Liquid sum_up(const Block& block, std::int64_t p, const std::int64_t* multiplicity,
                const double* water) const {
    Liquid liquid;
    for (std::int64_t i = block.item_begin(p); i < block.item_end(p); ++i) {
      const double mass = static_cast<double>(multiplicity[i]) * water[i];
      (water[i] < rain_mass_ ? liquid.cloud : liquid.rain) += mass;
    }
    return liquid;
  }

  /// Temperature, humidity and buoyancy. Returns Kelvin's length.
  double diagnose_air(const Block& block, std::int64_t p, const Liquid& liquid,
                      const Derived& out) const {
    const double z = block.in(height_)[p], theta = block.in(theta_)[p];
    const double vapour = block.in(vapour_)[p];
    const thermo::ReferenceState::Point at = reference_->at(z);
    const double t = at.exner * theta;
    if (!(t >= coldest_air)) refuse_cold(block.uid(p), z, t);
    if (out.temperature != nullptr) out.temperature[p] = t;
    const double all = liquid.cloud + liquid.rain;
    const bool moves = out.buoyancy != nullptr && block.has(previous_height_) &&
                       all > least_cloud && block.in(previous_height_)[p] != z;
    const bool needs_pressure = out.humidity != nullptr || out.droplets != nullptr || moves;
    const double pressure = needs_pressure ? thermo::pressure_of_exner(at.exner, kappa_) : 0.0;
    if (out.humidity != nullptr)
      out.humidity[p] = vapour == 0 ? 0.0 : air_.saturation_ratio(vapour, t, pressure).value;
    if (out.buoyancy != nullptr) {
      double condensed = 0;
      if (moves && is_cloudy(block.in(previous_height_)[p], theta, vapour))
        condensed = std::clamp(air_.air.condensed_on_the_way(z - block.in(previous_height_)[p],
                                                             theta, t, pressure, at),
                               -all, vapour);
      out.buoyancy[p] = buoyancy_scale_ * (thermo::virtual_potential_temperature(
                                               (t + air_.warming() * condensed) / at.exner,
                                               vapour - condensed, all + condensed) -
                                           at.theta_v);
    }
    return out.droplets != nullptr ? air_.kelvin(t) : 0.0;
  }

  /// Whether air that is where the droplets last were brought up to date is near saturation.
  bool is_cloudy(double height, double theta, double vapour) const {
    constexpr double nearly_saturated = 0.99;
    const Level at = level(height);
    const double t = air_.temperature(theta, at);
    return air_.saturation_ratio(vapour, t, at.pressure).value > nearly_saturated;
  }

  /// Number of droplets beyond their critical size: where more water lowers S_eq. Those of pure
  /// water all are.
  double count_activated(const Block& block, std::int64_t p, const std::int64_t* multiplicity,
                         const double* water, double kelvin) const {
    if (multiplicity == nullptr) return 0;
    const double* dry = block.has(dry_) ? block.in(dry_) : nullptr;
    const double* hygroscopic = block.has(hygroscopic_) ? block.in(hygroscopic_) : nullptr;
    double number = 0;
    for (std::int64_t i = block.item_begin(p); i < block.item_end(p); ++i) {
      const bool activated =
          dry == nullptr ||
          equilibrium_saturation(wet_radius(water[i], dry[i]), {dry[i], hygroscopic[i]}, kelvin)
                  .slope < 0;
      if (activated) number += static_cast<double>(multiplicity[i]);
    }
    return number;
  }

  Level level(double height) const {
    const double exner = reference_->at(height).exner;
    return {thermo::pressure_of_exner(exner, kappa_), exner, 0.0};
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
    d.op.id = "org.pileus.superdroplets";
    d.op.kind = "microphysics";
    d.op.version = "1.0.0";
    d.op.title = "Superdroplets on parcels: particles, droplets and their growth";
    d.op.summary =
        "Every parcel owns superdroplets that stand for its particles, droplets and drops; they "
        "take up and give off water as the supersaturation of their own parcel has it.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.flags = PILEUS_STIFF | PILEUS_RANDOM;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("size_resolved_droplets");
    d.provides("condensation", with_condensation);
    d.provides("activation", with_condensation);
    d.provides("buoyancy", with_derived_buoyancy);
    d.cites("10.1002/qj.441", "Shima et al. 2009: superdroplets");
    d.cites("10.5194/acp-7-1961-2007", "Petters & Kreidenweis 2007: kappa-Koehler theory");
    d.cites("10.5194/gmd-16-6211-2023", "Matsushima et al. 2023: sampling of sizes");
  }

  void describe_air(Declaration& d) {
    d.budget(water_budget);
    d.budget(aerosol_budget);
    height_ = d.reads("height", "m").doc("of the parcel's centre");
    volume_ = d.reads("parcel_volume", "m3").doc("times the reference density: the parcel's mass");
    previous_height_ = d.updates("previous_height", "m")
                           .intensive()
                           .when(condensing)
                           .doc("where the parcel was when its droplets were last advanced");
    theta_ = d.updates("air_potential_temperature", "K")
                 .intensive()
                 .range(50.0, 2000.0)
                 .when(in_moist_air);
    vapour_ = d.updates("specific_humidity", "1")
                  .intensive(water_budget)
                  .range(0.0, 1.0)
                  .when(in_moist_air);
    peak_ = d.owns("largest_supersaturation", "1")
                .intensive()
                .range(-1.0, 1e300)
                .initial(-1.0)
                .when(with_peak)
                .doc("met since the start");
  }

  void describe_droplets(Declaration& d) {
    multiplicity_ = d.owns_items(multiplicity_name).range(0.0, largest_multiplicity);
    water_ = d.owns_of_items(water_mass_name, "kg")
                 .of_each(multiplicity_name, water_budget)
                 .range(0.0, heaviest_drop);
    dry_ = d.owns_of_items(dry_volume_name, "m3")
               .of_each(multiplicity_name, aerosol_budget)
               .range(0.0, largest_particle)
               .when(on_aerosol);
    hygroscopic_ = d.owns_of_items(hygroscopic_volume_name, "m3")
                       .of_each(multiplicity_name)
                       .range(0.0, largest_particle)
                       .when(on_aerosol);
  }

  void describe_derived(Declaration& d) {
    cloud_ = d.derives("mass_fraction_of_cloud_liquid_water_in_air", "1")
                 .range(0.0, 1e3)
                 .on_demand()
                 .doc("in droplets up to the rain radius, haze included");
    rain_ = d.derives("mass_fraction_of_rain_in_air", "1")
                .range(0.0, 1e3)
                .on_demand()
                .doc("in drops beyond the rain radius");
    droplets_ = d.derives("number_of_cloud_droplets_per_mass_of_air", "kg-1")
                    .range(0.0, 1e300)
                    .on_demand()
                    .doc("beyond their critical size");
    temperature_ =
        d.derives("air_temperature", "K").range(coldest_air, 1e4).when(in_moist_air).on_demand();
    relative_humidity_ = d.derives("relative_humidity", "1")
                             .range(0.0, std::numeric_limits<double>::max())
                             .when(in_moist_air)
                             .on_demand()
                             .doc("over a plane surface of water");
    buoyancy_ = d.derives("buoyancy", "m s-2")
                    .range(-1e6, 1e6)
                    .when(with_derived_buoyancy)
                    .doc("total buoyancy, loading included");
  }

  /// Liquid water below which air is not looked at as cloud within a step, kg kg-1.
  static constexpr double least_cloud = 1e-8;

  Parameters parameters_;
  Slot height_, volume_, previous_height_, theta_, vapour_, peak_;
  Slot multiplicity_, water_, dry_, hygroscopic_;
  Slot cloud_, rain_, droplets_, temperature_, relative_humidity_, buoyancy_;
  DropletAir air_;
  VentilatedDrops drops_;
  std::optional<Condensation> condensation_;
  std::optional<AerosolSampler> sampler_;
  std::optional<thermo::ReferenceState> reference_;
  pileus_items_ext items_{};
  double density_ = 1, kappa_ = 0, buoyancy_scale_ = 0, rain_mass_ = 0;
  bool in_air_ = true;
};

}  // namespace pileus::superdroplets

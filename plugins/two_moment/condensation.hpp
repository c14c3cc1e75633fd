// Condensation, evaporation and activation of one parcel over a step: supersaturation relaxes
// exactly over sub-steps, vapour, water and heat change by the same increments.
#pragma once
#include <pileus/moist_air.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "activation.hpp"
#include "droplet_growth.hpp"
#include "rain_evaporation.hpp"
#include "relaxation.hpp"

namespace pileus::two_moment {

/// A parcel's prognostic state. Numbers are per kg of air.
struct Water {
  double theta = 0;      // K
  double vapour = 0;     // kg kg-1
  double cloud = 0;      // kg kg-1
  double droplets = 0;   // kg-1
  double aerosol = 0;    // kg-1, not activated; only where it is carried
  double rain = 0;       // kg kg-1
  double raindrops = 0;  // kg-1
};

/// What a step did besides what the state shows. Limiters cut an increment; repairs moved a number
/// into the range of sizes that exist.
struct Actions {
  int substeps = 0;
  int limited = 0;     // increments cut so that no phase became negative
  int repaired = 0;    // numbers moved to keep the mean size in its range
  double created = 0;  // kg-1: change of droplets and carried aerosol together
  double peak = 0;     // largest supersaturation met, 1
};

struct CondensationOptions {
  double embryo_radius = 1e-6;    // of a new droplet, m
  double substep_fraction = 0.5;  // c: of the relaxation time and of the time to the peak
  double peak_resolution = 3e-4;  // supersaturation within which activation must be resolved
  Spectrum spectrum = Spectrum::monodisperse;
  bool aerosol_carried = false;
  bool rain = false;
};

/// More sub-steps than any parcel needs; the rest of the step is then taken at once, which is as
/// stable and less accurate.
inline constexpr int most_condensation_substeps = 20000;

class Condensation {
 public:
  Condensation(const MoistAir& air, const Aerosol& aerosol, const CondensationOptions& options)
      : air_(air),
        aerosol_(aerosol),
        options_(options),
        embryo_(mass_of_radius(options.embryo_radius)),
        smallest_(std::min(embryo_, mass_of_radius(1e-6))) {}

  /// Advances a parcel that went from `from` to `to` in dt seconds.
  ///
  /// The driving A = (δ* − δ_0)/dt is the change of the excess δ = q_v − q_s along that way with
  /// the water held fixed (Morrison & Grabowski 2008); it needs no velocity.
  ///
  /// Ensures   no quantity becomes negative; q_v + q_c + q_r and θ − L/(c_p Π)·(q_c + q_r) at fixed
  ///           Π change by rounding alone
  Actions advance(Water& water, const Level& from, const Level& to, double dt) const {
    Actions did;
    Progress now;
    now.temperature = air_.temperature(water.theta, from);
    now.at = air_.saturation(now.temperature, from.pressure);
    now.excess = water.vapour - now.at.humidity;
    now.end_temperature = air_.temperature(water.theta, to);
    now.end = air_.saturation(now.end_temperature, to.pressure);
    now.rate = ((water.vapour - now.end.humidity) - now.excess) / dt;
    now.level = from;
    while (now.done < dt) {
      if (waits_for_saturation(water, now, dt)) break;
      if (now.done > 0) start(water, from, to, now, dt);
      substep(water, from, to, dt, now, did);
      ++did.substeps;
    }
    keep_sizes(water, did);
    return did;
  }

  /// Keeps the droplets' mean mass between the smallest and the largest, and that of drops below
  /// the largest, by their numbers alone.
  void keep_sizes(Water& water, Actions& did) const {
    if (options_.rain) keep_drop_sizes(water, did);
    double number = water.droplets;
    if (!(water.cloud > 0)) {
      number = 0;
    } else if (water.droplets * smallest_ > water.cloud) {
      number = water.cloud / smallest_;
    } else if (water.droplets * largest_droplet < water.cloud) {
      number = water.cloud / largest_droplet;
    }
    if (number == water.droplets) return;
    if (water.cloud > 0) ++did.repaired;
    const double gone = water.droplets - number;
    water.droplets = number;
    if (gone > 0) {
      give_back(water, gone, did);
    } else {
      did.created -= gone;
    }
  }

 private:
  static void keep_drop_sizes(Water& water, Actions& did) {
    double number = water.raindrops;
    if (!(water.rain > 0)) {
      number = 0;
    } else if (water.raindrops * largest_raindrop < water.rain) {
      number = water.rain / largest_raindrop;
    }
    if (number == water.raindrops) return;
    ++did.repaired;
    water.raindrops = number;
  }

  struct Progress {
    double done = 0;    // s
    double excess = 0;  // δ, kg kg-1
    double rate = 0;    // A, s-1
    Level level{};      // now
    double temperature = 0;
    Saturation at{};             // now
    double end_temperature = 0;  // at the end of the step if nothing more condensed
    Saturation end{};
  };

  /// The coefficients of one sub-step.
  struct Rates {
    double cloud = 0, rain = 0;  // increments of q per excess: 1/(τ Γ), s-1
    double gain = 1;             // Γ = 1 + (L/c_p) dq_s/dT
    double inverse_time() const { return (cloud + rain) * gain; }
  };

  static Level between(const Level& a, const Level& b, double fraction) {
    if (fraction >= 1) return b;
    return {a.pressure + fraction * (b.pressure - a.pressure),
            a.exner + fraction * (b.exner - a.exner),
            a.prescribed + fraction * (b.prescribed - a.prescribed)};
  }

  void start(const Water& water, const Level& from, const Level& to, Progress& now,
             double dt) const {
    now.level = between(from, to, now.done / dt);
    now.temperature = air_.temperature(water.theta, now.level);
    now.at = air_.saturation(now.temperature, now.level.pressure);
  }

  /// Without drops nothing happens below saturation: goes on to where it is reached, if it is.
  bool waits_for_saturation(const Water& water, Progress& now, double dt) const {
    if (now.excess >= 0 || water.cloud > 0 || water.rain > 0) return false;
    const double remaining = dt - now.done;
    if (!(now.excess + now.rate * remaining > 0)) return true;
    now.done += std::min(remaining, -now.excess / now.rate);
    now.excess = 0;
    return !(now.done < dt);
  }

  Rates rates(const Water& water, const Progress& now) const {
    Rates r;
    r.gain = 1.0 + air_.warming() * now.at.slope;
    const bool evaporates_rain = options_.rain && now.excess < 0 && water.rain > 0;
    if (!(water.cloud > 0 && water.droplets > 0) && !evaporates_rain) return r;
    const double p = now.level.pressure;
    const double growth =
        growth_coefficient(now.temperature, p, now.at.pressure, air_.constants.latent_heat,
                           air_.vapour_gas_constant());
    const double density = air_.density(now.temperature, p);
    const double scale = growth / now.at.humidity;
    if (water.cloud > 0 && water.droplets > 0) {
      const double mass = std::clamp(water.cloud / water.droplets, smallest_, largest_droplet);
      const double radius =
          radius_ratio(options_.spectrum, water.droplets * density) * radius_of_mass(mass);
      r.cloud = 4.0 * pi * water_density * water.droplets * radius * scale;
    }
    if (evaporates_rain)
      r.rain = rain_exchange(water.rain, water.raindrops, now.temperature, p, density) * scale;
    return r;
  }

  /// Number of droplets there would be at an excess, if it has been rising.
  double nuclei(const Water& water, double excess, const Progress& now) const {
    if (!(excess > 0)) return 0;
    if (options_.aerosol_carried && !(water.aerosol > 0)) return 0;
    double number;
    if (aerosol_.scheme() == ActivationScheme::arg2000) {
      const double t = now.temperature, p = now.level.pressure;
      const double growth = growth_coefficient(t, p, now.at.pressure, air_.constants.latent_heat,
                                               air_.vapour_gas_constant());
      const double sink = condensation_sink(t, p, now.at.pressure, air_.constants.latent_heat,
                                            air_.constants.heat_capacity,
                                            air_.vapour_gas_constant(), air_.constants.epsilon);
      number =
          aerosol_.peak(t, now.rate / now.at.humidity, growth, sink, air_.density(t, p)).activated;
    } else {
      number = aerosol_.activated(excess / now.at.humidity, now.temperature);
    }
    if (!options_.aerosol_carried) return number;
    return number * ((water.aerosol + water.droplets) / aerosol_.total());
  }

  /// The rest of the step, or what resolves the coming peak of supersaturation if it may activate:
  /// while δ rises towards A τ, which it cannot pass (τ only falls as droplets grow).
  double step_length(const Water& water, const Progress& now, double inverse_time, double remaining,
                     int taken) const {
    const double resolved = options_.peak_resolution * now.at.humidity / now.rate;
    const bool rising = now.rate > 0 && now.rate > now.excess * inverse_time;
    if (!rising || taken >= most_condensation_substeps) return remaining;
    double highest = now.excess + now.rate * remaining;
    if (inverse_time > 0) highest = std::min(highest, now.rate / inverse_time);
    if (!(nuclei(water, highest, now) > water.droplets)) return remaining;
    const double c = options_.substep_fraction;
    double h = std::min(remaining, c * resolved);
    if (inverse_time > 0) h = std::min(h, c / inverse_time);
    return h > 0 ? h : remaining;
  }

  void substep(Water& water, const Level& from, const Level& to, double dt, Progress& now,
               Actions& did) const {
    Rates r = rates(water, now);
    const double inverse_time = r.inverse_time();
    const double remaining = dt - now.done;
    const double h = step_length(water, now, inverse_time, remaining, did.substeps);
    const bool last = h >= remaining;
    const double before = now.excess;
    Relaxed relaxed = relax(before, now.rate, inverse_time, h);
    if (regrow(water, relaxed.taken, r)) relaxed = relax(before, now.rate, r.inverse_time(), h);
    const Level end = last ? to : between(from, to, (now.done + h) / dt);
    now.excess = relaxed.excess;
    if (relaxed.taken != 0 && inverse_time > 0) {
      if (!last || did.substeps > 0) {
        now.end_temperature = air_.temperature(water.theta, end);
        now.end = air_.saturation(now.end_temperature, end.pressure);
      }
      const double cut = exchange(water, relaxed.taken, r, end, now, did);
      now.excess -= r.gain * cut;
    }
    now.done = last ? dt : now.done + h;
    activate(water, before, end, now, did);
  }

  /// Droplets grow during the sub-step: replaces their radius in the rate by the mean of the radii
  /// at its beginning and, as the first estimate has it, at its end. False: there are none.
  bool regrow(const Water& water, double taken, Rates& r) const {
    if (!(r.cloud > 0)) return false;
    const double share = r.cloud / (r.cloud + r.rain);
    const double end = std::max(0.0, water.cloud + share * taken / r.gain);
    const double mass = std::clamp(water.cloud / water.droplets, smallest_, largest_droplet);
    const double later = std::clamp(end / water.droplets, smallest_, largest_droplet);
    r.cloud *= 0.5 + 0.5 * std::cbrt(later / mass);
    return true;
  }

  /// The increment of condensate that takes `taken` from the excess of air at now.end:
  /// Δq + q_s(T + a Δq) − q_s(T) = taken, a = L/c_p. Newton's method from Δq = taken/Γ; the left
  /// side is convex and increasing, so that it converges from one side, and quadratically. With
  /// τ → 0 this is saturation adjustment itself.
  double increment(double taken, double low, double high, const Level& end,
                   const Progress& now) const {
    const double a = air_.warming();
    double x = std::clamp(taken / (1.0 + a * now.end.slope), low, high);
    // A change of T by less than this bends q_s by ½ q_s'' T² < 5e-18: less than q_s is rounded by.
    constexpr double straight = 5e-7;
    if (a * std::abs(x) < straight) return x;
    for (int i = 0; i < 8; ++i) {
      const Saturation at = air_.saturation(now.end_temperature + a * x, end.pressure);
      const double residual = x + (at.humidity - now.end.humidity) - taken;
      const double next = std::clamp(x - residual / (1.0 + a * at.slope), low, high);
      const double change = std::abs(next - x);
      x = next;
      if (change <= 1e-7 * std::abs(x)) return x;
    }
    return bracketed_increment(taken, low, high, end, now);
  }

  /// The same for air near boiling, where q_s is not convex.
  double bracketed_increment(double taken, double low, double high, const Level& end,
                             const Progress& now) const {
    const double a = air_.warming();
    const auto residual = [&](double x) -> numerics::ValueAndSlope {
      const Saturation at = air_.saturation(now.end_temperature + a * x, end.pressure);
      return {x + (at.humidity - now.end.humidity) - taken, 1.0 + a * at.slope};
    };
    if (residual(low).value >= 0) return low;
    if (residual(high).value <= 0) return high;
    return numerics::bracketed_newton(residual, low, high, low, 1e-12).x;
  }

  /// Shares the increment out to cloud and rain by their rates. Returns by how much it exceeded
  /// what the limits let through.
  double exchange(Water& water, double taken, const Rates& r, const Level& end, const Progress& now,
                  Actions& did) const {
    const double a = air_.warming();
    const double all = -(water.cloud + water.rain);
    const double coldest = a > 0 ? std::min(0.0, (coldest_air - now.end_temperature) / a) : all;
    const double low = std::max(all, coldest);
    const double total = increment(taken, low, water.vapour, end, now);
    const double rain = r.rain > 0 && total < 0 ? total * (r.rain / (r.cloud + r.rain)) : 0.0;
    const double to_rain = std::max(rain, -water.rain);
    const double to_cloud = std::max(total - to_rain, -water.cloud);
    const bool cut = to_rain > rain || to_cloud > total - to_rain;
    if (cut || (total < 0 && total <= low) || (total > 0 && total >= water.vapour)) ++did.limited;
    move(water, to_cloud, to_rain, end, did);
    return to_cloud + to_rain - total;
  }

  /// Moves vapour into cloud and rain and its latent heat into the air.
  void move(Water& water, double to_cloud, double to_rain, const Level& level, Actions& did) const {
    double moved = to_cloud + to_rain;
    if (moved > water.vapour) {  // by rounding alone
      moved = water.vapour;
      to_cloud = moved - to_rain;
    }
    water.vapour -= moved;
    water.cloud += to_cloud;
    if (!air_.prescribed_temperature) water.theta += air_.warming() / level.exner * moved;
    if (to_rain == 0) return;
    const double left = water.rain + to_rain;
    const double gone = left > 0 ? water.raindrops * (-to_rain / water.rain) : water.raindrops;
    water.rain = left;
    water.raindrops -= gone;
    if (!options_.aerosol_carried) return;
    water.aerosol += gone;  // one particle from each drop
    did.created += gone;
  }

  /// Droplets that are none any more become aerosol again, or are forgotten.
  void give_back(Water& water, double particles, Actions& did) const {
    if (options_.aerosol_carried) {
      water.aerosol += particles;
    } else {
      did.created -= particles;
    }
  }

  /// New droplets, if the excess rose or there are none yet. Each takes the mass of an embryo; no
  /// more are made than the excess has water for.
  void activate(Water& water, double before, const Level& end, Progress& now, Actions& did) const {
    const double highest = std::max(before, now.excess);
    if (!(highest > 0)) return;
    did.peak = std::max(did.peak, highest / now.at.humidity);
    if (!(now.excess > before || water.droplets == 0)) return;
    double fresh = nuclei(water, highest, now) - water.droplets;
    if (!(fresh > 0)) return;
    if (options_.aerosol_carried) fresh = std::min(fresh, water.aerosol);
    const double gain = 1.0 + air_.warming() * now.at.slope;
    const double room = std::min(std::max(now.excess, 0.0) / gain, water.vapour);
    if (fresh * embryo_ > room) {
      fresh = room / embryo_;
      ++did.limited;
    }
    const double mass = fresh * embryo_;
    if (!(mass > 0)) return;
    move(water, mass, 0.0, end, did);
    now.excess -= gain * mass;
    water.droplets += fresh;
    if (options_.aerosol_carried) {
      water.aerosol = std::max(0.0, water.aerosol - fresh);
    } else {
      did.created += fresh;
    }
  }

  MoistAir air_;
  const Aerosol& aerosol_;
  CondensationOptions options_;
  double embryo_;    // kg
  double smallest_;  // kg
};

}  // namespace pileus::two_moment

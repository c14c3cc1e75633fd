// Condensation on the droplets of one parcel over a step: all droplets and the supersaturation they
// share are solved for together, over sub-steps as long as the accuracy allows.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "compensated_sum.hpp"
#include "droplet_air.hpp"
#include "stage.hpp"

namespace pileus::superdroplets {

/// A parcel's air.
struct Air {
  double theta = 0;   // K
  double vapour = 0;  // kg kg-1, by the measure of MoistAir
};

/// A parcel's droplets, all arrays of one length.
struct Droplets {
  std::span<double> water_mass;                // of one droplet, kg
  std::span<const std::int64_t> multiplicity;  // droplets in the parcel's air
  std::span<const double> dry_volume;          // of one droplet, m3
  std::span<const double> hygroscopic_volume;  // of one droplet, m3
  std::span<const double> ventilation = {};    // factor of growth; empty: 1
};

struct CondensationOptions {
  double tolerance = 1e-2;         // relative, see BasicCondensation
  double water_floor = 1e-7;       // liquid water that errors are never measured against less of
  double saturation_floor = 1e-3;  // the same of |S − 1|
  int most_substeps = 1000;        // tried; the rest of the step is then taken at once
};

/// What a step did besides what the state shows.
struct Outcome {
  double largest_supersaturation = -1;  // S − 1 met
  int substeps = 0;                     // taken
  int rejected = 0;                     // tried and not taken
  int fallbacks = 0;                    // stages that took the nested, bracketed search
};

/// `Surroundings` is DropletAir or has its functions.
///
/// Order      2 in the sub-step: SDIRK2 with γ = 1 − 1/√2 (Alexander 1977, doi:10.1137/0714068),
///            L-stable. The difference to backward Euler in liquid water and supersaturation is
///            kept below the tolerance times these; it is of first order, so that the error is
///            smaller by about the square root of the tolerance
/// Stability  every dt: the equations of S and of each droplet are bracketed where Newton's method
///            does not settle
/// Cost       five to six evaluations of each droplet per sub-step
template <class Surroundings>
class BasicCondensation {
 public:
  /// Doubles of scratch memory per droplet.
  static constexpr std::size_t scratch_per_droplet = DropletFields::arrays;

  BasicCondensation(const Surroundings& air, const CondensationOptions& options)
      : air_(air), options_(options) {}

  /// Advances a parcel of `air_mass` kg that went from `from` to `to` in dt seconds.
  ///
  /// Requires   scratch of scratch_per_droplet doubles per droplet
  /// Ensures    vapour and water change by one and the same amount, θ by L/(c_p Π) of it with Π of
  ///            the middle of each sub-step; nothing becomes negative
  Outcome advance(Air& air, const Droplets& droplets, double air_mass, const Level& from,
                  const Level& to, double dt, std::span<double> scratch) const {
    Outcome did;
    if (droplets.water_mass.empty() || !(air_mass > 0) || !(dt > 0)) return did;
    Run run{air, from, to, dt, fields(droplets, air_mass, scratch)};
    const double before = total_water(droplets.multiplicity, droplets.water_mass);
    begin(run, droplets);
    did.largest_supersaturation = saturation(run, run.water, from).value - 1.0;
    double h = dt, growth = most_growth;  // none after a rejection, then more again
    while (run.done < dt) {
      const double remaining = dt - run.done;
      const bool last_try =
          did.substeps + did.rejected >= options_.most_substeps ||
          did.fallbacks * static_cast<int>(std::min<std::size_t>(run.f.count, 1000)) >=
              most_searched;
      if (last_try || h > 0.99 * remaining) h = remaining;
      const double error = last_try ? backward_euler(run, did) : substep(run, h, did);
      const double change = error > 0 ? 0.9 / std::sqrt(error) : most_growth;
      if (error <= 1) {
        commit(run, h, did);
        h *= std::clamp(change, 0.1, growth);
        growth = std::min(most_growth, 1.5 * growth);
      } else {
        ++did.rejected;
        h *= std::clamp(change, 0.1, 0.7);
        growth = 1.0;
      }
      // The rest in equal parts rather than in a long and a short one.
      const double left = dt - run.done;
      if (left > 0 && h < left) h = left / std::ceil(left / h);
    }
    finish(run, droplets, before, air_mass, air, did);
    return did;
  }

 private:
  /// Searches are a hundred times dearer than a stage that settles; where they are the rule, in
  /// steps of hours or air beyond all limits, sub-steps bring nothing.
  static constexpr int most_searched = 400;                // droplets of all searches
  static constexpr double gamma = 0.29289321881345247560;  // 1 − 1/√2
  static constexpr double most_growth = 4.0;               // of a sub-step over the one before
  static constexpr double too_long = 16.0;  // error of a sub-step that has no solution

  struct Run {
    Air air;  // at the beginning of the sub-step
    Level from, to;
    double dt;
    DropletFields f;
    double done = 0;     // s
    double water = 0;    // q_l at the beginning of the sub-step
    double ratio = 0;    // S there
    double flow = 0;     // dq_l/dt of the last sub-step
    double heating = 0;  // dθ/dq_l, K, of this sub-step
    double next_water = 0;
    double peak = -1;  // S − 1 within this sub-step
    Level end{};
  };

  static DropletFields fields(const Droplets& droplets, double air_mass,
                              std::span<double> scratch) {
    DropletFields f;
    f.count = droplets.water_mass.size();
    double* next = scratch.data();
    for (double** field : {&f.weight, &f.dry, &f.solute, &f.floor, &f.start, &f.base, &f.area,
                           &f.shift, &f.response, &f.damping}) {
      *field = next;
      next += f.count;
    }
    if (!droplets.ventilation.empty()) f.ventilation = droplets.ventilation.data();
    for (std::size_t i = 0; i < f.count; ++i)
      f.weight[i] = static_cast<double>(droplets.multiplicity[i]) *
                    (sphere * drops::water_density / air_mass);
    return f;
  }

  static Level between(const Level& a, const Level& b, double fraction) {
    if (fraction >= 1) return b;
    return {a.pressure + fraction * (b.pressure - a.pressure),
            a.exner + fraction * (b.exner - a.exner),
            a.prescribed + fraction * (b.prescribed - a.prescribed)};
  }

  void begin(Run& run, const Droplets& droplets) const {
    const DropletFields& f = run.f;
    double water = 0;
    for (std::size_t i = 0; i < f.count; ++i) {
      f.dry[i] = droplets.dry_volume[i] / sphere;
      f.solute[i] = droplets.hygroscopic_volume[i] / sphere;
      const double wet = droplets.water_mass[i] / (drops::water_density * sphere) + f.dry[i];
      const double core = std::max(smallest_radius, std::cbrt(f.dry[i])), r = std::cbrt(wet);
      f.floor[i] = core * core;
      const double u = std::max(r * r, f.floor[i]);
      f.start[i] = f.area[i] = u;
      water += f.weight[i] * std::max(0.0, u * std::sqrt(u) - f.dry[i]);
    }
    run.water = water;
    run.ratio = saturation(run, water, run.from).value;
  }

  /// S and its slope in q_l at a level.
  numerics::ValueAndSlope saturation(const Run& run, double water, const Level& level) const {
    const double more = water - run.water;
    const double t = temperature(run, water, level);
    const SaturationRatio s = air_.saturation_ratio(run.air.vapour - more, t, level.pressure);
    const double per_water = air_.warming() > 0 ? run.heating * level.exner : 0.0;
    return {s.value, s.per_temperature * per_water - s.per_vapour};
  }
  double temperature(const Run& run, double water, const Level& level) const {
    return air_.temperature(run.air.theta + run.heating * (water - run.water), level);
  }

  /// Growth by the temperature t, but not by one far from that at the beginning: iterates may be.
  void set_coefficients(Stage& stage, const Run& run, double t, const Level& level) const {
    constexpr double farthest = 20.0;  // K
    const double now = temperature(run, run.water, level);
    const double temperature = std::clamp(t, now - farthest, now + farthest);
    stage.equation.kelvin = air_.kelvin(temperature);
    stage.equation.conductance = air_.conductance(temperature, level.pressure);
  }

  struct Solution {
    double water, saturation;
    double slope;  // ∂S/∂q_l
    double response;
  };

  /// All droplets and S of one stage from guesses of S and q_l; u holds the guess of the droplets.
  Solution solve(Stage& stage, const Run& run, const Level& level, double ratio, double water,
                 Outcome& did) const {
    constexpr int most_iterations = 14;
    constexpr double settled_ratio = 1e-4, settled_temperature = 1e-5;
    double s = ratio, step = 0;
    double t = temperature(run, water, level);
    set_coefficients(stage, run, t, level);
    for (int i = 0; i < most_iterations; ++i) {
      s += step;
      const Stage::Sums sums = stage.evaluate(s, step, i == 0);
      const numerics::ValueAndSlope now = saturation(run, sums.water, level);
      const bool settled =
          i > 0 && sums.moved == 0 && std::abs(step) <= settled_ratio * std::max(1.0, std::abs(s));
      step = (now.value - s + now.slope * sums.shift) / (1.0 - now.slope * sums.response);
      if (!std::isfinite(step)) break;
      if (settled) {
        const Solution found{stage.update(s, step), s + step, now.slope, sums.response};
        if (stage.keep_branches(found.saturation) == 0 && agrees(run, found, level)) return found;
        s = found.saturation;
        step = 0;
        continue;
      }
      const double expected = sums.water + sums.shift + sums.response * step;
      const double warmer = temperature(run, expected, level);
      if (i < 4 && std::abs(warmer - t) > settled_temperature) {
        t = warmer;
        set_coefficients(stage, run, t, level);
      }
    }
    return search(stage, run, level, did);
  }

  /// The same by nested brackets: S(q_l(S)) − S falls with S, from ≥ 0 at S = 0 to ≤ 0 at the
  /// saturation of air in which every droplet has dried. Where droplets leave a branch it may jump
  /// over 0: then the side that agrees better, of those that leave vapour.
  Solution search(Stage& stage, const Run& run, const Level& level, Outcome& did) const {
    ++did.fallbacks;
    Solution last{}, best{};
    double least = std::numeric_limits<double>::infinity();
    const auto excess = [&](double s) -> numerics::ValueAndSlope {
      const numerics::ValueAndSlope water = stage.solve_each(s);
      const numerics::ValueAndSlope now = saturation(run, water.value, level);
      last = {water.value, s, now.slope, water.slope};
      if (std::abs(now.value - s) < least && now.value >= 0) {
        least = std::abs(now.value - s);
        best = last;
      }
      return {s - now.value, 1.0 - now.slope * water.slope};
    };
    const double high = std::max(0.0, saturation(run, 0.0, level).value);
    if (excess(0.0).value >= 0) return last;
    numerics::bracketed_newton(excess, 0.0, high, std::min(run.ratio, high), 1e-13);
    if (std::isfinite(least) && best.saturation != last.saturation) excess(best.saturation);
    return last;
  }

  /// Error over tolerance of one SDIRK2 step; the droplets' u is then that of its end.
  double substep(Run& run, double h, Outcome& did) const {
    const DropletFields& f = run.f;
    const Level first = between(run.from, run.to, (run.done + gamma * h) / run.dt);
    begin_substep(run, h);
    Stage stage(f);
    stage.equation.duration = gamma * h;
    for (std::size_t i = 0; i < f.count; ++i) f.base[i] = f.area[i] = f.start[i];
    const Solution one = solve(stage, run, first, run.ratio, run.water + run.flow * gamma * h, did);
    const double more = (one.water - run.water) / gamma;
    const double ratio = std::max(0.0, run.ratio + (one.saturation - run.ratio) / gamma);
    extrapolate(stage, one.saturation, ratio, f);
    const Solution two = solve(stage, run, run.end, ratio, run.water + more, did);
    run.next_water = two.water;
    run.peak = peak(run.ratio, one.saturation, two.saturation);
    if (!agrees(run, one, first) || !agrees(run, two, run.end)) return too_long;
    return error(run, two);
  }

  /// S − 1 at the vertex of the parabola through S at 0, γ and 1, if it is a maximum between; else
  /// −1. The ends alone would miss as much of a peak as S bends in half a sub-step.
  static double peak(double start, double middle, double end) {
    const double first = (middle - start) / gamma, second = (end - middle) / (1.0 - gamma);
    const double bend = second - first;  // half the second derivative
    const double slope = first - bend * gamma;
    if (!(bend < 0) || !(slope > 0) || !(slope < -2.0 * bend)) return -1;
    return start - slope * slope / (4.0 * bend) - 1.0;
  }

  /// It is a solution: S is that of the air with its droplets, and leaves vapour, but for what
  /// rounding of q_l makes of S.
  bool agrees(const Run& run, const Solution& solution, const Level& level) const {
    constexpr double share = 0.01;  // of what the tolerance allows
    const double s = saturation(run, solution.water, level).value;
    const double scale = std::abs(s - 1.0) + options_.saturation_floor;
    const double rounding = 1e-15 * std::abs(solution.slope) * (solution.water + run.water);
    return s >= -rounding &&
           std::abs(s - solution.saturation) <= share * options_.tolerance * scale + rounding;
  }

  void begin_substep(Run& run, double h) const {
    run.end = between(run.from, run.to, (run.done + h) / run.dt);
    const Level middle = between(run.from, run.to, (run.done + 0.5 * h) / run.dt);
    run.heating = air_.warming() / middle.exner;
  }

  /// From the first stage's u to the base of the second, b = u_0 + (1 − γ)/γ (Y_1 − u_0), and a
  /// guess of its end. Where b has left the way to the droplet's equilibrium it is cut, for the
  /// equation from such a base would land on the other side: at the dry size; at Y_1 if haze would
  /// pass its equilibrium at the S expected; at the critical size if it would pass that at an S
  /// below the critical one.
  static void extrapolate(const Stage& stage, double first, double expected,
                          const DropletFields& f) {
    constexpr double factor = (1.0 - gamma) / gamma;
    const DropletEquation e = stage.equation;
    const double slope = 3.0 / e.kelvin;
    double passes[Stage::block];
    for (std::size_t from = 0; from < f.count; from += Stage::block) {
      const std::size_t n = std::min(Stage::block, f.count - from);
      double* __restrict const base = f.base + from;
      double* __restrict const area = f.area + from;
      const double *const start = f.start + from, *const floor = f.floor + from;
      const double *const dry = f.dry + from, *const solute = f.solute + from;
#pragma GCC ivdep
      for (std::size_t i = 0; i < n; ++i) {
        const double y = area[i], change = y - start[i], top = solute[i] * slope;
        const double wanted = start[i] + factor * change;
        const double b = wanted > floor[i] ? wanted : floor[i];
        const double away = (expected - e.equilibrium(b, dry[i], solute[i])) * change;
        const double low = b < top ? 1.0 : 0.0, high = y < top ? 1.0 : 0.0;
        const double overshot = away < 0 ? low * high : 0.0;
        const double cut = overshot > 0 ? y : b;
        const double next = overshot > 0 ? y : b + change;
        passes[i] = high - low * high;
        base[i] = cut;
        area[i] = next > floor[i] ? next : cut;
      }
      double any = 0;
      for (std::size_t i = 0; i < n; ++i) any += passes[i];
      if (!(any > 0)) continue;
      for (std::size_t i = 0; i < n; ++i) {
        const double top = solute[i] * slope;
        if (passes[i] > 0 && e.equilibrium(top, dry[i], solute[i]) > first) base[i] = area[i] = top;
      }
    }
  }

  /// The difference to backward Euler, (1 − γ) h (f_1 − f_2), damped by the stage's matrix so that
  /// what is stiff and has settled does not count. Of a droplet that dried within the sub-step,
  /// what backward Euler from its end would have left: all it lost.
  double error(const Run& run, const Solution& two) const {
    constexpr double factor = (1.0 - gamma) / gamma;
    const DropletFields& f = run.f;
    constexpr std::size_t block = Stage::block;
    double parts[block], sizes[block];
    LaneSum signed_sum, absolute_sum;
    for (std::size_t from = 0; from < f.count; from += block) {
      const std::size_t n = std::min(block, f.count - from);
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t i = from + k;
        const double e = (f.base[i] - f.start[i]) - factor * (f.area[i] - f.base[i]);
        const double u = f.area[i], was = f.start[i], root = std::sqrt(u);
        const double settled = 1.5 * root * (e * f.damping[i]);
        const double gained = u * root - was * std::sqrt(was);
        const double x = f.weight[i] * (f.base[i] > f.floor[i] ? settled : gained);
        parts[k] = x;
        sizes[k] = std::abs(x);
      }
      signed_sum.add(parts, n);
      absolute_sum.add(sizes, n);
    }
    const double shift = two.slope * signed_sum.total() / (1.0 - two.slope * two.response);  // of S
    const double water = std::abs(signed_sum.total() + two.response * shift);
    const double of_water = water / (two.water + options_.water_floor);
    const double of_ratio =
        std::abs(shift) / (std::abs(two.saturation - 1.0) + options_.saturation_floor);
    const double worst = std::max(of_water, of_ratio) / options_.tolerance;
    return std::isfinite(worst) ? worst : too_long;
  }

  /// The rest of the step by one backward Euler step, which keeps vapour positive. No error.
  double backward_euler(Run& run, Outcome& did) const {
    const double h = run.dt - run.done;
    const DropletFields& f = run.f;
    begin_substep(run, h);
    Stage stage(f);
    stage.equation.duration = h;
    for (std::size_t i = 0; i < f.count; ++i) f.base[i] = f.area[i] = f.start[i];
    run.next_water = solve(stage, run, run.end, run.ratio, run.water, did).water;
    run.peak = -1;
    return 0;
  }

  void commit(Run& run, double h, Outcome& did) const {
    run.ratio = saturation(run, run.next_water, run.end).value;
    run.flow = (run.next_water - run.water) / h;
    run.air.theta += run.heating * (run.next_water - run.water);
    run.air.vapour -= run.next_water - run.water;
    run.water = run.next_water;
    const double left = run.dt - run.done - h;
    run.done = left > 0 ? run.done + h : run.dt;
    std::copy_n(run.f.area, run.f.count, run.f.start);
    did.largest_supersaturation =
        std::max({did.largest_supersaturation, run.ratio - 1.0, run.peak});
    ++did.substeps;
  }

  /// Back to masses; vapour and θ by the change of their sum.
  void finish(const Run& run, const Droplets& droplets, double before, double air_mass, Air& air,
              Outcome& did) const {
    const DropletFields& f = run.f;
    for (std::size_t i = 0; i < f.count; ++i) {
      const double u = f.start[i];
      const double wet = u * std::sqrt(u) - f.dry[i];
      f.area[i] = u > f.floor[i] && wet > 0 ? wet * (sphere * drops::water_density) : 0.0;
    }
    const std::span<double> mass(f.area, f.count);
    double condensed = (total_water(droplets.multiplicity, mass) - before) / air_mass;
    double theta = run.air.theta + run.heating * (condensed - (air.vapour - run.air.vapour));
    if (!(condensed <= air.vapour) || !std::isfinite(theta)) {
      // No solution left vapour, which nothing known leads to; or it did but for rounding. Whatever
      // it was: as much of the change as there is vapour for.
      const double share =
          condensed > air.vapour && std::isfinite(condensed) ? air.vapour / condensed : 0.0;
      for (std::size_t i = 0; i < f.count; ++i)
        mass[i] = share > 0 ? droplets.water_mass[i] + share * (mass[i] - droplets.water_mass[i])
                            : droplets.water_mass[i];
      condensed = (total_water(droplets.multiplicity, mass) - before) / air_mass;
      theta = air.theta + run.heating * condensed;
      ++did.fallbacks;
    }
    std::copy_n(f.area, f.count, droplets.water_mass.data());
    air.theta = theta;
    air.vapour = std::max(0.0, air.vapour - condensed);  // of the order of rounding
  }

  Surroundings air_;
  CondensationOptions options_;
};

using Condensation = BasicCondensation<DropletAir>;

}  // namespace pileus::superdroplets

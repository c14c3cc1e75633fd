// Rain from cloud: droplets that merge into drizzle, drops that sweep up droplets and each other.
#pragma once
#include <algorithm>
#include <cmath>

#include "condensation.hpp"
#include "droplet_growth.hpp"
#include "rain_evaporation.hpp"

namespace pileus::two_moment {

/// Rates of change by collection. Masses per kg of air, numbers per kg; all s-1 and never negative,
/// but for the raindrops' own balance.
struct CollectionRates {
  double autoconversion = 0;  // of cloud water to rain, s-1
  double accretion = 0;       // of cloud water to rain, s-1
  double droplets = 0;        // lost, kg-1 s-1
  double new_raindrops = 0;   // kg-1 s-1
  double raindrops = 0;       // change by self-collection and break-up, kg-1 s-1
};

/// Khairoutdinov & Kogan (2000, doi:10.1175/1520-0493(2000)128<0229:ANCPPI>2.0.CO;2), eqs 29
/// and 33: fits to bin simulations of drizzling stratocumulus.
struct KhairoutdinovKogan {
  static constexpr double drizzle_mass = 6.544984694978736e-11;  // of a drop of 25 µm, kg

  /// Mixing ratios in kg/kg; `number` is that of droplets in cm-3.
  ///
  /// At least 100 m-3 are counted: the fit was not made for fewer, and N^−1.79 has no bound.
  static double autoconversion(double cloud, double number) {
    return 1350.0 * std::exp(2.47 * std::log(cloud) - 1.79 * std::log(std::max(number, 1e-4)));
  }
  static double accretion(double cloud, double rain) {
    return 67.0 * std::exp(1.15 * std::log(cloud * rain));
  }

  CollectionRates rates(const Water& water, double density) const {
    CollectionRates r;
    if (!(water.cloud > 0)) return r;
    if (water.droplets > 0)
      r.autoconversion = autoconversion(water.cloud, 1e-6 * density * water.droplets);
    if (water.rain > 0) r.accretion = accretion(water.cloud, water.rain);
    r.droplets = (r.autoconversion + r.accretion) * (water.droplets / water.cloud);
    r.new_raindrops = r.autoconversion / drizzle_mass;
    return r;
  }
};

/// Seifert & Beheng (2001, doi:10.1016/S0169-8095(01)00126-0; 2006, doi:10.1007/s00703-005-0112-4):
/// rates from the stochastic collection equation with a similarity function of the rain's share.
struct SeifertBeheng {
  static constexpr double separation_mass = 2.6e-10;  // x*, kg
  double cloud_kernel = 4.44e9;                       // k_cc, m3 kg-2 s-1
  double shape = 1.0;                                 // ν of the droplets' distribution

  /// Loss of cloud water, kg m-3 s-1, for water contents in kg m-3 (2006, eqs 4 and 6).
  double autoconversion(double cloud, double number, double rain, double density) const {
    const double mean = std::min(cloud / number, separation_mass);
    const double tau = std::clamp(rain / (cloud + rain), 0.0, 1.0 - 1e-12);
    double similarity = 1.0;
    if (tau > 0) {
      const double t = std::pow(tau, 0.7), rest = 1.0 - t;
      similarity += 400.0 * t * rest * rest * rest / ((1.0 - tau) * (1.0 - tau));
    }
    const double nu = shape;
    return cloud_kernel / (20.0 * separation_mass) * (nu + 2.0) * (nu + 4.0) /
           ((nu + 1.0) * (nu + 1.0)) * cloud * cloud * mean * mean * similarity *
           (surface_density / density);
  }
  /// Loss of cloud water to drops, kg m-3 s-1 (2006, eqs 7 and 8).
  static double accretion(double cloud, double rain, double density) {
    if (!(rain > 0)) return 0;
    const double tau = rain / (cloud + rain);
    const double ratio = tau / (tau + 5e-5);
    const double square = ratio * ratio;
    return 5.25 * cloud * rain * square * square * std::sqrt(surface_density / density);
  }
  /// Droplets that merge, autoconversion included, m-3 s-1 (2006, eq. 9).
  double droplet_merging(double cloud, double density) const {
    return cloud_kernel * (shape + 2.0) / (shape + 1.0) * cloud * cloud *
           (surface_density / density);
  }
  /// Raindrops that merge, m-3 s-1 (2006, with the exponent −5 that integrating the stated
  /// kernel gives; the paper prints −9).
  static double raindrop_merging(double rain, double number, double mass, double density) {
    const double slope = std::cbrt(6.0 / mass);  // λ, kg^-1/3
    const double base = 1.0 + 60.7 / slope;
    const double square = base * base;
    return 7.12 * number * rain / (square * square * base) * std::sqrt(surface_density / density);
  }
  /// Φ_br of 2006: break-up makes Φ_br + 1 drops per drop lost to merging. Above
  /// the equilibrium diameter the continuous form 2(exp(2300 ΔD) − 1).
  static double breakup(double mass) {
    const double diameter = std::cbrt(6.0 / (pi * water_density) * mass);
    const double above = diameter - 0.9e-3;
    if (diameter < 0.35e-3) return -1.0;
    return above <= 0 ? 1000.0 * above : 2.0 * std::expm1(2300.0 * above);
  }

  CollectionRates rates(const Water& water, double density) const {
    CollectionRates r;
    const double rain = water.rain * density, drops = water.raindrops * density;
    if (water.cloud > 0) {
      const double cloud = water.cloud * density;
      double converted = 0;
      if (water.droplets > 0)
        converted = autoconversion(cloud, water.droplets * density, rain, density);
      const double swept = accretion(cloud, rain, density);
      r.autoconversion = converted / density;
      r.accretion = swept / density;
      r.droplets =
          std::max(droplet_merging(cloud, density), 2.0 * converted / separation_mass) / density +
          r.accretion * (water.droplets / water.cloud);
      r.new_raindrops = r.autoconversion / separation_mass;
    }
    if (rain > 0 && drops > 0) {
      const double mass = std::clamp(rain / drops, largest_droplet, largest_raindrop);
      r.raindrops = raindrop_merging(rain, drops, mass, density) * breakup(mass) / density;
    }
    return r;
  }
};

/// Largest share of the cloud water, or of a number, that one sub-step turns over.
inline constexpr double collection_share = 0.1;
inline constexpr int most_collection_substeps = 10000;

/// Of a drop of 0.9 mm, where merging and break-up balance (Seifert & Beheng 2006), kg.
inline constexpr double equilibrium_mass = pi / 6.0 * water_density * 0.9e-3 * 0.9e-3 * 0.9e-3;

namespace detail {

/// Share of each quantity that collection turns over per second.
struct CollectionShares {
  double cloud = 0, droplets = 0, raindrops = 0;  // s-1; of raindrops the signed growth
  double drops_per_mass = 0;                      // new raindrops per mass that leaves the cloud
  double fastest() const { return std::max({cloud, droplets, std::abs(raindrops)}); }
};

template <class Scheme>
CollectionShares collection_shares(const Scheme& scheme, const Water& water, double density) {
  const CollectionRates r = scheme.rates(water, density);
  const double loss = r.autoconversion + r.accretion;
  CollectionShares share;
  if (loss > 0) share.cloud = loss / water.cloud, share.drops_per_mass = r.new_raindrops / loss;
  if (water.droplets > 0) share.droplets = r.droplets / water.droplets;
  if (water.raindrops > 0) share.raindrops = r.raindrops / water.raindrops;
  return share;
}

/// Exponential decay at constant shares for h: never more than there is. What cloud loses is what
/// rain gains; half of the new drops meet the others' self-collection.
inline void turn_over(Water& water, const CollectionShares& share, double h) {
  const double moved = -water.cloud * std::expm1(-h * share.cloud);
  water.cloud -= moved;
  water.rain += moved;
  // Droplets at their largest are drizzle: there merging stops, which else would end in finite
  // time.
  water.droplets = std::max(water.droplets * std::exp(-h * share.droplets),
                            std::min(water.droplets, water.cloud / largest_droplet));
  const double born = 0.5 * moved * share.drops_per_mass;
  const double met = water.raindrops + born;
  double drops = met * std::exp(h * share.raindrops);
  // In a step too long to follow, break-up ends where the drops have their equilibrium size.
  if (h * share.raindrops > collection_share)
    drops = std::min(drops, std::max(met, water.rain / equilibrium_mass));
  water.raindrops = drops + born;
}

}  // namespace detail

/// Advances collection by dt in sub-steps of second order: the shares turned over per second are
/// those at the middle of the sub-step, as the shares at its beginning predict it.
///
/// Ensures   q_c + q_r changes by rounding alone; nothing becomes negative; did.created falls by
/// the
///           droplets lost
template <class Scheme>
void collect(const Scheme& scheme, Water& water, double density, double dt, Actions& did) {
  double done = 0;
  const double droplets = water.droplets;
  for (int k = 0; done < dt && (water.cloud > 0 || water.rain > 0); ++k) {
    const detail::CollectionShares first = detail::collection_shares(scheme, water, density);
    const double fastest = first.fastest();
    if (fastest == 0) break;
    const double remaining = dt - done;
    const bool rest = !(fastest * remaining > collection_share) || k >= most_collection_substeps;
    const double h = rest ? remaining : collection_share / fastest;
    Water middle = water;
    detail::turn_over(middle, first, 0.5 * h);
    detail::turn_over(water, detail::collection_shares(scheme, middle, density), h);
    done = rest ? dt : done + h;
    ++did.substeps;
  }
  did.created -= droplets - water.droplets;
}

}  // namespace pileus::two_moment

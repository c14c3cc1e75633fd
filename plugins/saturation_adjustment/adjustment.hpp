// Saturation adjustment at a point: how much of the water is liquid, and the buoyancy that follows.
#pragma once
#include <pileus/numerics.hpp>
#include <pileus/thermo.hpp>

#include <cstdint>

namespace pileus::saturation {

/// A parcel's equilibrium.
struct Equilibrium {
  double temperature;  // K
  double liquid;       // kg kg-1
  int iterations;      // evaluations of the residual; 0 when unsaturated
};

/// Relative Newton step at which the search ends. The last step is still taken, and for the
/// residual below its error is at most (max f''/2f')·step² ≈ 0.05 K-1·(3e-7 K)² = 5e-15 K: below
/// rounding.
inline constexpr double newton_tolerance = 1e-9;

/// Temperature and liquid water of air with liquid-water temperature `temperature_l` = Π θ_l and
/// total water `total`, for a saturation humidity q_s(T) that returns value and slope.
///
/// Solves f(T) = T − T_l − (L/c_p)(q_t − q_s(T)) = 0. f' ≥ 1 because q_s increases, f(T_l) < 0 and
/// f(T_l + L/c_p·q_t) ≥ 0: there is exactly one root, it is bracketed, and the safeguarded Newton
/// search ends for every input. q_s is convex below the boiling point, so Newton from T_l
/// overshoots once and then descends monotonically: four or five evaluations in clouds.
///
/// Ensures    T = T_l and no liquid if q_t ≤ q_s(T_l); else 0 ≤ q_l ≤ q_t and
///            T − (L/c_p) q_l = T_l to rounding, so that θ_l and q_t are conserved
/// Source     Siebesma et al. 2003 (closure form, θ_l and q_t conserved); bracket and proof: ours
template <class SaturationHumidity>
Equilibrium adjust(double temperature_l, double total, double latent_over_heat,
                   SaturationHumidity&& saturation) {
  if (!(total > saturation(temperature_l).value)) return {temperature_l, 0.0, 0};
  const auto residual = [&](double temperature) -> numerics::ValueAndSlope {
    const numerics::ValueAndSlope q = saturation(temperature);
    return {temperature - temperature_l - latent_over_heat * (total - q.value),
            1.0 + latent_over_heat * q.slope};
  };
  const double high = temperature_l + latent_over_heat * total;
  const numerics::Root root =
      numerics::bracketed_newton(residual, temperature_l, high, temperature_l, newton_tolerance);
  const double liquid = (root.x - temperature_l) / latent_over_heat;
  return {root.x, liquid < total ? liquid : total, root.iterations};
}

/// Idealised moist air (Dritschel et al. 2018, doi:10.1002/qj.3319, section 2): saturation depends
/// on height alone, q_s = q_0 exp(−(z − z_0)/H), and liquid adds buoyancy G q_l with
/// G = g L/(c_p θ_00).
struct IdealAir {
  double surface_humidity;  // q_0, kg kg-1
  double base_height;       // z_0, m
  double scale_height;      // H, m
  double latent_buoyancy;   // G, m s-2

  /// Liquid water, kg kg-1. Free of branches and calls: a loop over it is vector code.
  double liquid(double height, double total) const {
    const double saturated =
        surface_humidity * numerics::vector_exp((base_height - height) / scale_height);
    const double excess = total - saturated;
    return excess > 0.0 ? excess : 0.0;
  }

  /// The same where nothing saturates: b = b_l. Adding G·0 is not left out, since it turns −0 into
  /// 0: the bits are those of `diagnose` with no liquid.
  static void diagnose_unsaturated(std::int64_t count, const double* __restrict buoyancy_l,
                                   double* __restrict buoyancy) {
    for (std::int64_t p = 0; p < count; ++p) buoyancy[p] = buoyancy_l[p] + 0.0;
  }

  /// Total buoyancy b = b_l + G q_l (m s-2) and liquid water of `count` parcels; no array overlaps
  /// another.
  void diagnose(std::int64_t count, const double* __restrict height,
                const double* __restrict buoyancy_l, const double* __restrict total,
                double* __restrict buoyancy, double* __restrict wet) const {
    const IdealAir air = *this;  // a copy the stores below cannot be thought to change
    for (std::int64_t p = 0; p < count; ++p) {
      const double q = air.liquid(height[p], total[p]);
      wet[p] = q;
      buoyancy[p] = buoyancy_l[p] + air.latent_buoyancy * q;
    }
  }
};

}  // namespace pileus::saturation

// Rates at which two drops meet and merge: K in m3 s-1, symmetric in the two.
#pragma once
#include <pileus/drops.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>

#include "fall_speed_table.hpp"
#include "hall_efficiency.hpp"

namespace pileus::superdroplets {

/// What kernels may know of a drop.
struct Drop {
  double mass, radius, speed;  // kg, m, m s-1
};

/// A kernel that needs the two masses (kg) alone.
template <class K>
concept KernelOfMasses = requires(const K& kernel, double mass) {
  { kernel(mass, mass) } -> std::convertible_to<double>;
};

/// A kernel that needs sizes and fall speeds.
template <class K>
concept KernelOfFallingDrops = requires(const K& kernel, const Drop& drop) {
  { kernel(drop, drop) } -> std::convertible_to<double>;
};

struct ConstantKernel {
  double value = 1e-10;  // m3 s-1
  double operator()(double, double) const { return value; }
};

/// b (X + x), X and x volumes: has an exact solution (Golovin 1963).
struct GolovinKernel {
  double coefficient = 1500.0;  // b, s-1
  double operator()(double a, double b) const {
    return coefficient / drops::water_density * (a + b);
  }
};

/// Long (1974, doi:10.1175/1520-0469(1974)031<1040:STTDCE>2.0.CO;2), eq. 11: polynomials of the
/// volumes that need no fall speed.
struct LongPolynomialKernel {
  static constexpr double square_coefficient = 9.44e15;  // m-3 s-1, larger drop up to 50 µm
  static constexpr double linear_coefficient = 5.78e3;   // s-1, beyond
  static constexpr double join =                         // mass of a drop of 50 µm, kg
      4.0 / 3.0 * drops::pi * drops::water_density * 50e-6 * 50e-6 * 50e-6;
  double operator()(double a, double b) const {
    constexpr double volume = 1.0 / drops::water_density;
    return std::max(a, b) <= join ? square_coefficient * (volume * volume) * (a * a + b * b)
                                  : linear_coefficient * volume * (a + b);
  }
};

/// Volume swept by the larger drop relative to the smaller: π (R + r)² |v_R − v_r|, m3 s-1.
inline double swept_volume(const Drop& a, const Drop& b) {
  const double reach = a.radius + b.radius;
  return drops::pi * (reach * reach) * std::abs(a.speed - b.speed);
}

/// Swept volume times a constant efficiency.
struct GeometricKernel {
  double efficiency = 1.0;
  double operator()(const Drop& a, const Drop& b) const { return efficiency * swept_volume(a, b); }
};

/// Swept volume times Long's collection efficiency as used by Bott (1998) and Simmel et al. (2002,
/// doi:10.1016/S0169-8095(01)00131-4): 4.5e8 R² (1 − 3 µm/r) between 1e-3 and 1, and 1 from 50 µm.
struct LongKernel {
  static double efficiency(double large, double small) {
    constexpr double least = 1e-3, cutoff = 3e-6, join = 50e-6, coefficient = 4.5e8;
    if (large >= join) return 1.0;
    const double e = coefficient * (large * large) * (1.0 - cutoff / small);
    return std::min(std::max(e, least), 1.0);
  }
  double operator()(const Drop& a, const Drop& b) const {
    return efficiency(std::max(a.radius, b.radius), std::min(a.radius, b.radius)) *
           swept_volume(a, b);
  }
};

/// Swept volume times Hall's collision efficiency.
struct HallKernel {
  double operator()(const Drop& a, const Drop& b) const {
    return hall_efficiency(std::max(a.radius, b.radius), std::min(a.radius, b.radius)) *
           swept_volume(a, b);
  }
};

/// A kernel of falling drops as one of masses: sizes and speeds come from a table.
template <KernelOfFallingDrops Kernel>
struct TabulatedKernel {
  Kernel kernel;
  const FallSpeedTable& table;
  double operator()(double a, double b) const {
    const RadiusAndSpeed at_a = table(a), at_b = table(b);
    return kernel(Drop{a, at_a.radius, at_a.speed}, Drop{b, at_b.radius, at_b.speed});
  }
};
template <class Kernel>
TabulatedKernel(Kernel, const FallSpeedTable&) -> TabulatedKernel<Kernel>;

}  // namespace pileus::superdroplets

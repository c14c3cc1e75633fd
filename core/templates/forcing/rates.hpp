// Newtonian cooling at a point. Pure functions, SI units, no host needed.
#pragma once
#include <pileus/numerics.hpp>

namespace rates {

/// Buoyancy after `dt` (s) of relaxation towards an equilibrium.
///
/// Solves  db/dt = (b_eq − b)/τ  exactly.
///
/// Units     buoyancies m s-2, dt and time_scale τ in s, τ > 0
/// Ensures   between b and b_eq for every step; b itself, bit for bit, for dt = 0
/// Source    Held & Suarez 1994, doi:10.1175/1520-0477(1994)075<1825:APFTIO>2.0.CO;2; the exact
///           solution is elementary
inline double cooled(double buoyancy, double equilibrium, double dt, double time_scale) {
  return pileus::numerics::relaxed(buoyancy, equilibrium, dt / time_scale);
}

}  // namespace rates

// Autoconversion at a point: how much cloud becomes rain. Pure functions, SI units, no host needed.
#pragma once
#include <pileus/numerics.hpp>

namespace rates {

/// Cloud that is left after `dt` (s) of autoconversion.
///
/// Solves  dq_c/dt = −k max(0, q_c − a)  exactly: what exceeds the threshold decays.
///
/// Units     cloud q_c and threshold a kg kg-1, rate k s-1
/// Ensures   cloud itself, bit for bit, for dt = 0 or at most the threshold; never below it else
/// Source    Kessler 1969, doi:10.1007/978-1-935704-36-2_1; the exact solution is elementary
inline double cloud_left(double cloud, double threshold, double rate, double dt) {
  if (!(cloud > threshold)) return cloud;
  return pileus::numerics::relaxed(cloud, threshold, rate * dt);
}

}  // namespace rates

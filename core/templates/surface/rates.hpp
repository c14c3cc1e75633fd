// Exchange with the ground at a point. Pure functions, SI units, no host needed.
#pragma once
#include <pileus/numerics.hpp>

namespace rates {

/// Value of air in a layer of depth h after `dt` (s) of exchange with a surface.
///
/// Solves  h dq/dt = C (q_s − q)  exactly: the flux C (q_s − q) is spread over the layer.
///
/// Units     q and surface q_s alike; transfer_velocity C m s-1, depth h m, h > 0
/// Ensures   between q and q_s for every step; q itself, bit for bit, for dt = 0
/// Source    Wesely & Hicks 2000, doi:10.1016/S1352-2310(99)00467-7 (flux by transfer velocity);
/// the
///           exact solution is elementary
inline double exchanged(double q, double surface, double transfer_velocity, double depth,
                        double dt) {
  return pileus::numerics::relaxed(q, surface, transfer_velocity * dt / depth);
}

}  // namespace rates

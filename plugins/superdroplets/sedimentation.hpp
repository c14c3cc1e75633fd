// Drops that fall through parcels: how far down in its parcel a drop is, when it leaves, and who
// owns it next.
//
// A drop keeps its height relative to its parcel, s from −1 (bottom) to 1 (top of the parcel's
// vertical half-extent a), and nothing of its horizontal place, which is therefore anywhere in the
// parcel's cross-section at that height, ∝ (V/a)(1 − s²). As the drop falls, the part of the
// cross-sections that lies outside of the one below has left through the lower surface: of the
// drops at s_0 ≤ 0 the share (1 − s²)/(1 − s_0²) is still there at s. Above the centre none leaves.
//
// What leaves at a height enters a parcel through its upper surface there, which is the growth of
// the cross-section downwards, ∝ V/a² · s for s > 0. Where parcels fill space the sum of all
// cross-sections is the same at every height, so that as many drops leave as can enter, and drops
// that are evenly distributed over the air stay so.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace pileus::superdroplets {

/// The vertical extent of a parcel.
struct ParcelSpan {
  double height;       // of its centre, m
  double half_extent;  // m
  double volume;       // m3
};

/// Relative height of a drop placed at random in an ellipsoid, by a uniform draw: the horizontal
/// cross-sections are ∝ 1 − s², so that u = (2 + 3s − s³)/4, whose root is s = 2 sin(asin(2u −
/// 1)/3).
inline double random_relative_height(double u) {
  return 2.0 * std::sin(std::asin(2.0 * u - 1.0) / 3.0);
}

/// Relative height at which a drop leaves that falls from s, by a uniform draw; one that has been
/// left below its parcel leaves where it is.
inline double exit_height(double s, double u) {
  if (!(s > -1.0)) return s;
  const double from = s < 0.0 ? s : 0.0;
  return -std::sqrt(1.0 - u * (1.0 - from * from));
}

inline double height_of(double relative_height, const ParcelSpan& parcel) {
  return parcel.height + relative_height * parcel.half_extent;
}
inline double relative_height_in(const ParcelSpan& parcel, double height) {
  return (height - parcel.height) / parcel.half_extent;
}

/// Upper surface of a parcel at a height, seen from above, over a factor common to all parcels: 0
/// below its centre and beyond its top.
inline double upper_surface(const ParcelSpan& parcel, double height) {
  const double s = relative_height_in(parcel, height);
  return s > 0.0 && s < 1.0 ? parcel.volume / (parcel.half_extent * parcel.half_extent) * s : 0.0;
}

/// Horizontal cross-section of a parcel at a height, over a factor common to all parcels.
inline double cross_section(const ParcelSpan& parcel, double height) {
  const double s = relative_height_in(parcel, height);
  return s * s < 1.0 ? parcel.volume / parcel.half_extent * (1.0 - s * s) : 0.0;
}

/// The parcel that takes drops over.
struct Receiver {
  std::size_t parcel;      // its position among the candidates, their number if there are none
  double relative_height;  // of the drop in it; beyond ±1 where no parcel reaches the drop
  double share;            // of the drops that it takes at once
  bool reaches;            // whether any parcel reaches the drop
};

/// Chooses an owner for drops among the parcels of their column by one uniform draw of (0, 1): in
/// proportion to the upper surfaces at their height; where there are none, to the cross-sections
/// there; and where no parcel reaches, the one that is nearest in units of its half-extent, in
/// which the drops keep their true height.
///
/// A superdroplet stands for drops of a parcel of `volume`; given as a whole to a much smaller
/// parcel it would be a downpour there. Such a parcel takes the share V/volume only and is chosen
/// as much more often, so that all get what is due to them on average; the rest is handed out by
/// further draws.
inline Receiver choose_receiver(double height, std::span<const ParcelSpan> candidates,
                                double volume, double u) {
  constexpr double least_share = 1.0 / 16;  // bounds the superdroplets that come of one
  const auto share_of = [&](const ParcelSpan& parcel) {
    return parcel.volume < volume ? std::max(parcel.volume / volume, least_share) : 1.0;
  };
  for (double (*surface)(const ParcelSpan&, double) : {upper_surface, cross_section}) {
    const auto weight_of = [&](const ParcelSpan& parcel) {
      return surface(parcel, height) / share_of(parcel);
    };
    double total = 0;
    for (const ParcelSpan& parcel : candidates) total += weight_of(parcel);
    if (!(total > 0)) continue;
    std::size_t chosen = candidates.size();
    double before = 0;
    for (std::size_t q = 0; q < candidates.size(); ++q) {
      const double weight = weight_of(candidates[q]);
      if (!(weight > 0)) continue;
      chosen = q;  // rounding may leave u·total above the sum: then the last one
      before += weight;
      if (u * total < before) break;
    }
    return {chosen, relative_height_in(candidates[chosen], height), share_of(candidates[chosen]),
            true};
  }
  std::size_t chosen = candidates.size();
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t q = 0; q < candidates.size(); ++q) {
    const double away = std::abs(relative_height_in(candidates[q], height));
    if (!(away < nearest)) continue;
    nearest = away;
    chosen = q;
  }
  if (chosen == candidates.size()) return {chosen, 0.0, 1.0, false};
  return {chosen, relative_height_in(candidates[chosen], height), 1.0, false};
}

}  // namespace pileus::superdroplets

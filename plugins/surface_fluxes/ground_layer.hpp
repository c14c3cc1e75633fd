// Putting what comes out of the ground into the parcels next to it, exactly, and reading from them
// what the air there is like.
//
// Surface points j are the centres of the columns of cells. A parcel p belongs to them by
// w_pj = (bilinear weight between the four nearest points, periodic) × (vertical weight), and
//
//   Δφ_p = Σ_j M_j w_pj/S_j,   S_j = Σ_p V_p w_pj   so that   Σ_p V_p Δφ_p = Σ_j M_j
//
// to rounding, wherever the parcels are. All loops are serial over the few parcels near the ground,
// in their order: the same bits for any number of threads.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace pileus::surface {

/// The ground and the lowest layer of cells.
struct Ground {
  std::array<std::int64_t, 2> cells{1, 1};  // in x and y; one in y in two dimensions
  std::array<double, 2> origin{}, spacing{1, 1};
  double bottom = 0, depth = 1;  // of the lowest cell, h
  double height = 1;             // of the domain

  std::size_t points() const { return static_cast<std::size_t>(cells[0] * cells[1]); }
  double area() const { return spacing[0] * spacing[1]; }  // of a point, m2
  double cell_volume() const { return area() * depth; }
};

/// What is known of all parcels. `y` is null in two dimensions.
struct ParcelArrays {
  const double *x, *y, *z, *volume;
  std::int64_t count;
};

/// How a parcel's weight depends on its height above the ground, for a reach r: 1 − z/r, the shape
/// of the force of the ground; 1 below r; and 1 − |z/r − 1|, for values at the height r.
enum class VerticalWeight { ramp, box, tent };

inline double vertical_weight(VerticalWeight shape, double height, double reach) {
  const double s = std::max(height, 0.0) / reach;
  switch (shape) {
    case VerticalWeight::ramp:
      return std::max(1.0 - s, 0.0);
    case VerticalWeight::box:
      return s < 1.0 ? 1.0 : 0.0;
    case VerticalWeight::tent:
      return std::max(1.0 - std::abs(s - 1.0), 0.0);
  }
  return 0.0;
}

/// The four points around a parcel.
struct Corners {
  std::array<std::size_t, 4> point{};
  std::array<double, 4> weight{};
};

inline Corners corners_around(const Ground& ground, double x, double y) {
  std::array<std::array<std::size_t, 2>, 2> at{};
  std::array<double, 2> part{};
  const std::array<double, 2> place{x, y};
  for (std::size_t d = 0; d < 2; ++d) {
    const auto n = static_cast<double>(ground.cells[d]);
    double along = (place[d] - ground.origin[d]) / ground.spacing[d] - 0.5;
    // A place that is not a number, or far outside, must not lead outside the ground.
    if (!(std::abs(along) < 1e12)) along = 0;
    const double below = std::floor(along);
    part[d] = along - below;
    const double wrapped = std::clamp(below - n * std::floor(below / n), 0.0, n - 1);
    at[d] = {static_cast<std::size_t>(wrapped), wrapped + 1 < n ? std::size_t(wrapped) + 1 : 0};
  }
  const auto columns = static_cast<std::size_t>(ground.cells[0]);
  Corners c;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t i = k % 2, j = k / 2;
    c.point[k] = at[0][i] + columns * at[1][j];
    c.weight[k] = (i == 0 ? 1 - part[0] : part[0]) * (j == 0 ? 1 - part[1] : part[1]);
  }
  return c;
}

/// Weights of the parcels at the points for one vertical shape.
struct PointSums {
  std::span<double> reach;   // m
  std::span<double> volume;  // S_j, m3; 0 where no parcel is in reach, however far
};

class GroundLayer {
 public:
  /// `reach`: the height below which every shape of this layer ends. `near` has to hold
  /// count_below(…, reach) indices; they are filled in.
  GroundLayer(const Ground& ground, const ParcelArrays& parcels, double reach,
              std::span<std::int64_t> near)
      : ground_(ground), parcels_(parcels), near_(near) {
    std::size_t n = 0;
    for (std::int64_t p = 0; p < parcels.count; ++p)
      if (parcels.z[p] < ground.bottom + reach) near_[n++] = p;
  }
  static std::size_t count_below(const Ground& ground, const ParcelArrays& parcels, double reach) {
    return static_cast<std::size_t>(std::count_if(
        parcels.z, parcels.z + parcels.count, [&](double z) { return z < ground.bottom + reach; }));
  }

  /// A point with less than this part of a cell has no parcels to speak of.
  static constexpr double least_part = 1e-3;

  /// S_j of every point, for a shape that ends at (tent: has its peak at) the height `reach`.
  /// Points with next to no parcels reach twice as far, and twice that, up to the height of the
  /// domain. Returns how many did.
  std::uint64_t weigh(VerticalWeight shape, double reach, const PointSums& sums) {
    std::fill(sums.reach.begin(), sums.reach.end(), reach);
    std::fill(sums.volume.begin(), sums.volume.end(), 0.0);
    each(shape, sums.reach, [&](std::int64_t p, std::size_t j, double w) {
      sums.volume[j] += parcels_.volume[p] * w;
    });
    std::uint64_t widened = 0;
    for (std::size_t j = 0; j < sums.reach.size(); ++j) widened += lacks(sums, j);
    if (widened == 0) return 0;
    everyone_ = true;
    while (widen(sums)) {
      for (std::size_t j = 0; j < sums.reach.size(); ++j)
        if (lacks(sums, j)) sums.volume[j] = -0.0;
      each(shape, sums.reach, [&](std::int64_t p, std::size_t j, double w) {
        if (lacks_marked(sums, j)) sums.volume[j] -= parcels_.volume[p] * w;
      });
      for (double& s : sums.volume) s = std::abs(s);
    }
    for (std::size_t j = 0; j < sums.reach.size(); ++j)
      if (lacks(sums, j)) sums.volume[j] = 0;
    return widened;
  }

  /// φ_p += Σ_j share_j w_pj with share_j = M_j/S_j.
  void add(VerticalWeight shape, const PointSums& sums, std::span<const double> share,
           double* values) const {
    each(shape, sums.reach, [&](std::int64_t p, std::size_t j, double w) {
      if (w > 0) values[p] += share[j] * w;
    });
  }

  /// The same for mass fractions. A parcel that does not have what is to be taken from it ends at
  /// zero, one that would be more than water at one; what it lacked (negative) or could not take is
  /// added to `owed` at the points that asked for it, in units of M_j. Returns how many parcels
  /// that were.
  std::uint64_t add_to_fraction(VerticalWeight shape, const PointSums& sums,
                                std::span<const double> share, double* values,
                                std::span<double> owed) const {
    std::uint64_t cut = 0;
    each_parcel([&](std::int64_t p) {
      const Corners c = corners(p);
      double given = 0, taken = 0;
      std::array<double, 4> part{};
      for (std::size_t k = 0; k < 4; ++k) {
        part[k] = share[c.point[k]] * weight(shape, sums.reach, p, c, k);
        (part[k] > 0 ? given : taken) += part[k];
      }
      if (given == 0 && taken == 0) return;
      const double available = values[p] + given;
      values[p] = available + taken;
      if (!(values[p] < 0 || values[p] > 1)) return;
      const bool dry = values[p] < 0;
      const double bound = dry ? 0 : 1, beyond = values[p] - bound, all = dry ? taken : given;
      for (std::size_t k = 0; k < 4; ++k)
        if (dry ? part[k] < 0 : part[k] > 0)
          owed[c.point[k]] += parcels_.volume[p] * beyond * (part[k] / all);
      values[p] = bound;
      ++cut;
    });
    return cut;
  }

  /// Volume-weighted means of the parcels' values at the points; `otherwise` where there are none.
  void mean(VerticalWeight shape, const PointSums& sums, const double* values, double otherwise,
            std::span<double> means) const {
    std::fill(means.begin(), means.end(), 0.0);
    each(shape, sums.reach, [&](std::int64_t p, std::size_t j, double w) {
      if (w > 0) means[j] += parcels_.volume[p] * w * values[p];
    });
    for (std::size_t j = 0; j < means.size(); ++j)
      means[j] = sums.volume[j] > 0 ? means[j] / sums.volume[j] : otherwise;
  }

 private:
  bool lacks(const PointSums& sums, std::size_t j) const {
    return !(sums.volume[j] >= least_part * ground_.cell_volume());
  }
  /// While sums are made again, those of points that lack parcels are negative.
  static bool lacks_marked(const PointSums& sums, std::size_t j) {
    return std::signbit(sums.volume[j]);
  }
  /// Lets the points that lack parcels reach further. False if none can.
  bool widen(const PointSums& sums) const {
    bool any = false;
    for (std::size_t j = 0; j < sums.reach.size(); ++j) {
      if (!lacks(sums, j) || sums.reach[j] >= ground_.height) continue;
      sums.reach[j] = std::min(2 * sums.reach[j], ground_.height);
      any = true;
    }
    return any;
  }

  Corners corners(std::int64_t p) const {
    return corners_around(ground_, parcels_.x[p], parcels_.y != nullptr ? parcels_.y[p] : 0.0);
  }
  double weight(VerticalWeight shape, std::span<const double> reach, std::int64_t p,
                const Corners& c, std::size_t k) const {
    return c.weight[k] * vertical_weight(shape, parcels_.z[p] - ground_.bottom, reach[c.point[k]]);
  }
  template <class F>
  void each_parcel(F&& f) const {
    if (everyone_) {
      for (std::int64_t p = 0; p < parcels_.count; ++p) f(p);
    } else {
      for (const std::int64_t p : near_) f(p);
    }
  }
  /// f(p, j, w_pj) for all parcels that may be in reach and the points around them.
  template <class F>
  void each(VerticalWeight shape, std::span<const double> reach, F&& f) const {
    each_parcel([&](std::int64_t p) {
      const Corners c = corners(p);
      for (std::size_t k = 0; k < 4; ++k) f(p, c.point[k], weight(shape, reach, p, c, k));
    });
  }

  Ground ground_;
  ParcelArrays parcels_;
  std::span<std::int64_t> near_;
  bool everyone_ = false;  // some point reaches beyond the layer: all parcels are looked at
};

}  // namespace pileus::surface

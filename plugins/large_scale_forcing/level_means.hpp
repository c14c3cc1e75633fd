// Means over the levels of the mesh, gathered from the parcels, and changes of the levels given
// back to them: one-dimensional, with tent weights of the height of a parcel's centre.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace pileus::large_scale {

/// Levels k = 0 … cells at bottom + k·spacing. The hat function of a level is one there, zero at
/// its neighbours and linear between; at any height the hat functions sum to one.
struct Levels {
  double bottom = 0, spacing = 1;
  std::size_t cells = 1;

  std::size_t count() const { return cells + 1; }
  double height(std::size_t k) const { return bottom + static_cast<double>(k) * spacing; }
  double top() const { return height(cells); }
  double depth() const { return static_cast<double>(cells) * spacing; }
  /// Integral of the hat function of a level: half a spacing at the walls.
  double length(std::size_t k) const { return k == 0 || k == cells ? 0.5 * spacing : spacing; }

  /// The level below a height, and the weight of the level above that.
  struct Place {
    std::size_t below;
    double above;
  };
  /// What lies beyond a wall, or is not a number, counts as lying on one.
  Place place(double z) const {
    const double s = (z - bottom) / spacing;
    if (!(s > 0)) return {0, 0.0};
    if (s >= static_cast<double>(cells)) return {cells - 1, 1.0};
    const std::size_t k = std::min(static_cast<std::size_t>(s), cells - 1);
    return {k, s - static_cast<double>(k)};
  }
};

/// What is linear between values on the levels, at a place.
inline double between(const double* on_levels, Levels::Place at) {
  return (1.0 - at.above) * on_levels[at.below] + at.above * on_levels[at.below + 1];
}

/// Parcels as a column sees them.
struct Column {
  const double *height, *volume;
  std::int64_t count;
};

/// Parcels per chunk: sums are formed in chunks and added in their order, so that they do not
/// depend on the number of threads.
inline constexpr std::int64_t chunk_size = 4096;

inline std::size_t chunks_of(std::int64_t parcels) {
  return static_cast<std::size_t>((parcels + chunk_size - 1) / chunk_size);
}

/// Volume, mean height and means of some quantities of each level: with w_k the hat function,
///   V_k = Σ V w_k(z),  z̄_k = Σ V w_k z / V_k,  φ_k = Σ V w_k φ / V_k.
/// At a wall the mean height of evenly spread parcels is a third of a spacing inside.
class LevelMeans {
 public:
  /// Doubles that gathering needs.
  static std::size_t room(const Levels& levels, std::int64_t parcels, std::size_t quantities) {
    return (chunks_of(parcels) + 1) * levels.count() * (2 + quantities);
  }

  /// Gathers `quantities` (values of all parcels each) in the given room, which has to stay.
  /// `in_chunks(n, grain, body)` calls body(begin, end) for all chunks of 0 … n−1.
  template <class InChunks>
  LevelMeans(const Levels& levels, const Column& parcels, std::span<const double* const> quantities,
             std::span<double> space, InChunks&& in_chunks)
      : levels_(levels), width_(2 + quantities.size()), records_(space.data()) {
    const std::size_t size = levels.count() * width_;
    std::fill_n(records_, (chunks_of(parcels.count) + 1) * size, 0.0);
    in_chunks(parcels.count, chunk_size, [&](std::int64_t begin, std::int64_t end) {
      const auto chunk = static_cast<std::size_t>(begin / chunk_size);
      add_parcels(parcels, quantities, begin, end, records_ + (1 + chunk) * size);
    });
    for (std::size_t chunk = 0; chunk < chunks_of(parcels.count); ++chunk)
      for (std::size_t i = 0; i < size; ++i) records_[i] += records_[(1 + chunk) * size + i];
    for (std::size_t k = 0; k < levels.count(); ++k) divide_by_volume(records_ + k * width_);
    if (parcels.count > 0) spare_ = {records_ + size, 2 * levels.count()};
  }

  bool is_empty(std::size_t k) const { return !(volume(k) > 0); }
  double volume(std::size_t k) const { return records_[k * width_]; }
  /// Mean height of what a level holds; its own where it holds nothing.
  double height(std::size_t k) const {
    return is_empty(k) ? levels_.height(k) : levels_.bottom + records_[k * width_ + 1];
  }
  double mean(std::size_t k, std::size_t quantity) const {
    return records_[k * width_ + 2 + quantity];
  }
  bool any_empty() const {
    for (std::size_t k = 0; k < levels_.count(); ++k)
      if (is_empty(k)) return true;
    return false;
  }
  /// Two doubles per level of the room that gathering needed and nothing needs any more; of a run
  /// without parcels nothing.
  std::span<double> spare() const { return spare_; }

 private:
  void add_parcels(const Column& parcels, std::span<const double* const> quantities,
                   std::int64_t begin, std::int64_t end, double* sums) const {
    for (std::int64_t p = begin; p < end; ++p) {
      const double z = parcels.height[p];
      const Levels::Place at = levels_.place(z);
      double* below = sums + at.below * width_;
      double* above = below + width_;
      const double share_above = parcels.volume[p] * at.above;
      const double share_below = parcels.volume[p] - share_above;
      const auto add = [&](std::size_t entry, double value) {
        below[entry] += share_below * value;
        above[entry] += share_above * value;
      };
      add(0, 1.0);
      add(1, z - levels_.bottom);
      for (std::size_t q = 0; q < quantities.size(); ++q) add(2 + q, quantities[q][p]);
    }
  }

  void divide_by_volume(double* record) const {
    if (!(record[0] > 0)) return;
    for (std::size_t i = 1; i < width_; ++i) record[i] /= record[0];
  }

  Levels levels_;
  std::size_t width_;
  double* records_;  // of the levels, then of the levels in each chunk
  std::span<double> spare_;
};

/// Adds increments given on the levels: φ_p += Σ_k w_k(z_p) d_k. With d_k = X_k / V_k the parcels
/// receive ΣX_k together, whatever their places: Σ_p V_p w_k(z_p) is V_k.
inline double added(double value, const double* increments, Levels::Place at) {
  return value + between(increments, at);
}

/// The same in proportion to what a parcel holds, of a quantity that only some parcels have and
/// that is never negative: φ_p += φ_p Σ_k w_k(z_p) r_k with r_k = d_k / φ_k brings about Σ_k V_k
/// d_k as well, and no parcel loses more than it has as long as r_k ≥ −1.
inline double scaled(double value, const double* ratios, Levels::Place at) {
  return value + value * between(ratios, at);
}

/// Relaxes towards targets on the levels: φ_p += Σ_k w_k f_k (target_k − φ_p), 0 ≤ f_k ≤ 1. Where
/// the targets are the levels' means, Σ V φ stays the same; as a mean with positive weights the
/// result lies between φ_p and the targets.
inline double relaxed(double value, const double* parts, const double* targets, Levels::Place at) {
  const double below = (1.0 - at.above) * parts[at.below];
  const double above = at.above * parts[at.below + 1];
  const double low_target = targets[at.below], high_target = targets[at.below + 1];
  const double result =
      (1.0 - std::min(below + above, 1.0)) * value + (below * low_target + above * high_target);
  if (below + above == 0) return value;
  // A level of no weight has no say; the bounds take away rounding alone.
  double low = value, high = value;
  if (below > 0) low = std::min(low, low_target), high = std::max(high, low_target);
  if (above > 0) low = std::min(low, high_target), high = std::max(high, high_target);
  return std::clamp(result, low, high);
}

}  // namespace pileus::large_scale

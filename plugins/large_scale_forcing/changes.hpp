// Changes of several quantities by level, carried out on the parcels in one pass.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "level_means.hpp"

namespace pileus::large_scale {

/// How an increment of a level is shared among its parcels.
enum class Sharing {
  evenly,
  evenly_above_zero,  // cut where it would make a value negative
  in_proportion       // to what each has
};

/// What happens to one quantity. Arrays are over the levels.
struct Change {
  double* values = nullptr;  // of the parcels
  Sharing sharing = Sharing::evenly;
  double* increments = nullptr;          // or ratios, where shared in proportion; null: none
  const double* relaxed_part = nullptr;  // 0 … 1 of the distance to `target`; null: none
  double* target = nullptr;
};

/// Amounts that were cut to keep values from becoming negative, and how often.
struct Cuts {
  double amount = 0, count = 0;
};

inline double changed(const Change& change, double value, Levels::Place at) {
  double result = value;
  if (change.relaxed_part != nullptr)
    result = relaxed(value, change.relaxed_part, change.target, at);
  if (change.increments == nullptr) return result;
  if (change.sharing == Sharing::in_proportion)
    return result + (scaled(value, change.increments, at) - value);
  return added(result, change.increments, at);
}

/// Changes the parcels begin … end − 1; returns what was cut from it.
inline Cuts carry_out(const Change& change, const Levels& levels, const Column& parcels,
                      std::int64_t begin, std::int64_t end) {
  Cuts cuts;
  for (std::int64_t p = begin; p < end; ++p) {
    const double value = change.values[p];
    double result = changed(change, value, levels.place(parcels.height[p]));
    if (change.sharing != Sharing::evenly && result < 0 && value >= 0) {
      cuts.amount -= parcels.volume[p] * result;
      cuts.count += 1;
      result = 0;
    }
    change.values[p] = result;
  }
  return cuts;
}

}  // namespace pileus::large_scale

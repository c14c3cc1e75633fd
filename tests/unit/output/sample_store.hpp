// A store of parcels with random contents, every bit pattern of a double allowed.
#pragma once
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "parcels/store.hpp"

namespace pileus::output {

inline std::vector<parcels::Scalar> sample_scalars() {
  return {{"buoyancy", "m s-2", parcels::Nature::intensive, "", -1, 1, 0},
          {"total_water", "1", parcels::Nature::intensive, "water", 0, 1, 0},
          {"liquid_water", "1", parcels::Nature::derived, "", 0, 1, 0}};
}

/// Random bits, so that NaN payloads, infinities, denormals and minus zero all occur.
inline void fill_with_bits(parcels::Store& store, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (std::size_t p = 0; p < store.size(); ++p) store.uid()[p] = random();
  for (int column = 0; column < store.column_count(); ++column)
    for (std::size_t p = 0; p < store.size(); ++p) {
      const std::uint64_t bits = random();
      std::memcpy(store.column(column) + p, &bits, sizeof bits);
    }
}

/// Random numbers in (−1, 1).
inline void fill_with_numbers(parcels::Store& store, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (std::size_t p = 0; p < store.size(); ++p) store.uid()[p] = random();
  for (int column = 0; column < store.column_count(); ++column)
    for (std::size_t p = 0; p < store.size(); ++p) store.column(column)[p] = uniform(random);
}

/// Whether all state columns and uids are equal bit by bit.
inline bool same_state(const parcels::Store& a, const parcels::Store& b) {
  if (a.size() != b.size() || a.state_columns() != b.state_columns()) return false;
  if (std::memcmp(a.uid(), b.uid(), a.size() * sizeof(std::uint64_t)) != 0) return false;
  for (int column = 0; column < a.state_columns(); ++column)
    if (std::memcmp(a.column(column), b.column(column), a.size() * sizeof(double)) != 0)
      return false;
  return true;
}

}  // namespace pileus::output

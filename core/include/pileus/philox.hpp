// Counter-based random numbers: the generator and the keys are part of the plugin contract.
//
// A draw depends on what it is for, never on what was drawn before, so results do not change with
// the number of threads, the order of parcels, skipping or a restart. The host service `uniform`
// and this header give the same bits.
#pragma once
#include <array>
#include <cstdint>

namespace pileus {

/// Philox4x32 with ten rounds (Salmon et al. 2011, doi:10.1145/2063384.2063405, section 4.3).
inline std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                               std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t multiplier0 = 0xD2511F53u, multiplier1 = 0xCD9E8D57u;
  constexpr std::uint32_t weyl0 = 0x9E3779B9u, weyl1 = 0xBB67AE85u;
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t product0 = multiplier0 * counter[0];
    const std::uint64_t product1 = multiplier1 * counter[2];
    counter = {static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key[0],
               static_cast<std::uint32_t>(product1),
               static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key[1],
               static_cast<std::uint32_t>(product0)};
    key[0] += weyl0;
    key[1] += weyl1;
  }
  return counter;
}

/// The finaliser of SplitMix64 (Steele et al. 2014, doi:10.1145/2714064.2660195): a bijection of
/// 64 bits in which every input bit reaches every output bit.
inline std::uint64_t mix_bits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

/// What a draw is for.
struct DrawKey {
  std::uint64_t seed = 0;     // of the run
  std::uint32_t stream = 0;   // who draws
  std::uint64_t uid = 0;      // for which parcel (or cell)
  std::uint64_t number = 0;   // at which step; the low 32 bits count
  std::uint32_t call = 0;     // which call within the step, below 1024
  std::uint32_t channel = 0;  // what for, below 64
};

/// Largest number of draws of one channel: 2^16 counters of two draws.
inline constexpr std::uint32_t most_draws = 131072;

/// The two key words of a (seed, stream).
inline std::array<std::uint32_t, 2> philox_key(std::uint64_t seed, std::uint32_t stream) {
  const std::uint64_t key = mix_bits(mix_bits(seed + 0x9E3779B97F4A7C15u) + stream);
  return {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)};
}

/// The counter of draws 2·pair and 2·pair + 1: uid low, uid high, step, call|channel|pair in
/// 10, 6 and 16 bits from the top.
inline std::array<std::uint32_t, 4> philox_counter(const DrawKey& key, std::uint32_t pair) {
  return {static_cast<std::uint32_t>(key.uid), static_cast<std::uint32_t>(key.uid >> 32),
          static_cast<std::uint32_t>(key.number),
          (key.call & 1023u) << 22 | (key.channel & 63u) << 16 | (pair & 65535u)};
}

/// A number of the open interval (0,1): 52 bits, centred, so that 1 is never reached by rounding.
inline double open_unit_interval(std::uint32_t low, std::uint32_t high) {
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32 | low) >> 12;
  return (static_cast<double>(bits) + 0.5) * 0x1p-52;
}

/// Draws 0 … n−1 of a key, n ≤ most_draws.
inline void draw_uniform(const DrawKey& key, std::uint32_t n, double* out) {
  const std::array<std::uint32_t, 2> words = philox_key(key.seed, key.stream);
  for (std::uint32_t i = 0; i < n; i += 2) {
    const auto bits = philox4x32(philox_counter(key, i / 2), words);
    out[i] = open_unit_interval(bits[0], bits[1]);
    if (i + 1 < n) out[i + 1] = open_unit_interval(bits[2], bits[3]);
  }
}

}  // namespace pileus

// Random words of 32 bits by their number, many at a time.
#pragma once
#include <pileus/philox.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace pileus::superdroplets {

/// An endless sequence of Philox blocks that belongs to a key and a number.
///
/// Block i of sequence 0 is that of `philox_counter(key, i)`, for i < 2^16; further blocks and
/// further sequences have key words of their own, so that one (cell, step, channel) is good for any
/// number of droplets and of sub-steps.
class RandomWords {
 public:
  static constexpr std::size_t lanes = 16;  // blocks made at once

  RandomWords(const DrawKey& key, std::uint32_t sequence) : key_(key), sequence_(sequence) {}

  std::array<std::uint32_t, 4> block(std::uint64_t number) const {
    return philox4x32(philox_counter(key_, static_cast<std::uint32_t>(number)), words(number));
  }

  /// Words 0 … 3 of `lanes` blocks from `first`, a multiple of `lanes`: out[word][block − first].
  void blocks(std::uint64_t first, std::uint32_t (&out)[4][lanes]) const {
    const std::array<std::uint32_t, 4> start =
        philox_counter(key_, static_cast<std::uint32_t>(first));
    std::array<std::uint32_t, 2> key = words(first);
    for (std::size_t l = 0; l < lanes; ++l) {
      for (std::size_t w = 0; w < 3; ++w) out[w][l] = start[w];
      out[3][l] = start[3] + static_cast<std::uint32_t>(l);
    }
    for (int round = 0; round < 10; ++round) {
      turn(out, key);
      key = {key[0] + 0x9E3779B9u, key[1] + 0xBB67AE85u};
    }
  }

 private:
  std::array<std::uint32_t, 2> words(std::uint64_t number) const {
    const std::uint64_t page = static_cast<std::uint64_t>(sequence_) << 32 | number >> 16;
    return philox_key(key_.seed ^ mix_bits(page), key_.stream);  // mix_bits(0) = 0
  }

  /// One round of philox4x32 in all lanes.
  static void turn(std::uint32_t (&x)[4][lanes], const std::array<std::uint32_t, 2>& key) {
    for (std::size_t l = 0; l < lanes; ++l) {
      const std::uint64_t product0 = std::uint64_t{0xD2511F53u} * x[0][l];
      const std::uint64_t product1 = std::uint64_t{0xCD9E8D57u} * x[2][l];
      x[0][l] = static_cast<std::uint32_t>(product1 >> 32) ^ x[1][l] ^ key[0];
      x[2][l] = static_cast<std::uint32_t>(product0 >> 32) ^ x[3][l] ^ key[1];
      x[1][l] = static_cast<std::uint32_t>(product1);
      x[3][l] = static_cast<std::uint32_t>(product0);
    }
  }

  DrawKey key_;
  std::uint32_t sequence_;
};

}  // namespace pileus::superdroplets

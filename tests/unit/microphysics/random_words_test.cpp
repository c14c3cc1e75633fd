// The random words of a call are Philox blocks: the plugin contract's own, then others.
#include "../../../plugins/superdroplets/random_words.hpp"

#include <gtest/gtest.h>

#include <set>

namespace pileus::superdroplets {
namespace {

const DrawKey key{123, 4, (std::uint64_t{1} << 40) + 5, 678, 9, 10};

TEST(RandomWords, many_at_once_are_those_one_by_one) {
  for (const std::uint32_t sequence : {0u, 1u, 255u}) {
    const RandomWords random(key, sequence);
    for (const std::uint64_t first : {0u, 16u, 65520u, 65536u, 1048576u}) {
      std::uint32_t words[4][RandomWords::lanes];
      random.blocks(first, words);
      for (std::size_t l = 0; l < RandomWords::lanes; ++l) {
        const auto block = random.block(first + l);
        for (std::size_t w = 0; w < 4; ++w) EXPECT_EQ(words[w][l], block[w]);
      }
    }
  }
}

TEST(RandomWords, of_the_first_sequence_are_the_plain_draws_of_the_key) {
  double draws[4];
  draw_uniform(key, 4, draws);
  const RandomWords random(key, 0);
  for (std::uint64_t b = 0; b < 2; ++b) {
    const auto block = random.block(b);
    EXPECT_EQ(open_unit_interval(block[0], block[1]), draws[2 * b]);
    EXPECT_EQ(open_unit_interval(block[2], block[3]), draws[2 * b + 1]);
  }
}

TEST(RandomWords, never_repeat_between_sequences_and_pages) {
  std::set<std::array<std::uint32_t, 4>> seen;
  for (std::uint32_t sequence = 0; sequence < 64; ++sequence) {
    for (const std::uint64_t number : {0u, 1u, 65535u, 65536u, 65537u, 131072u})
      seen.insert(RandomWords(key, sequence).block(number));
  }
  EXPECT_EQ(seen.size(), 64u * 6u);
}

}  // namespace
}  // namespace pileus::superdroplets

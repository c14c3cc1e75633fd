// The random numbers of the plugin contract: known answers, and both implementations alike.
#include "base/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace pileus {
namespace {

using Words = std::array<std::uint32_t, 4>;

TEST(Philox, gives_the_known_answers_of_random123) {
  // Random123 1.09, tests/kat_vectors, philox4x32 10.
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}),
            (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Draws, are_the_same_from_the_host_and_from_the_header) {
  const DrawKey key{12345, 0x80000007u, 0xFEDCBA9876543210u, 77, 1023, 63};
  std::vector<double> ours(1001), theirs(1001);
  draw_uniform(key, 1001, ours.data());
  draw_random(key, theirs);
  EXPECT_EQ(ours, theirs);
  EXPECT_EQ(draw_one(key), ours[0]);
}

TEST(Draws, stay_inside_the_open_interval) {
  EXPECT_EQ(open_unit_interval(0, 0), 0x1p-53);
  EXPECT_EQ(open_unit_interval(0xFFFFFFFFu, 0xFFFFFFFFu), 1.0 - 0x1p-53);
}

TEST(Draws, of_neighbouring_keys_are_uncorrelated) {
  // Mean and lag correlation of n uniforms have standard errors sqrt(1/12n) and 1/sqrt(n).
  constexpr int n = 1 << 16;
  double mean = 0, product = 0, before = 0.5;
  for (int i = 0; i < n; ++i) {
    const double u = draw_one({1, 2, static_cast<std::uint64_t>(i), 4, 5, 6});
    mean += u / n;
    product += 12 * (u - 0.5) * (before - 0.5) / n;
    before = u;
  }
  EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(1.0 / (12 * n)));
  EXPECT_NEAR(product, 0.0, 5 / std::sqrt(n));
}

}  // namespace
}  // namespace pileus

// What happens to the two superdroplets of one pair, and to inputs at the edge of sense.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "../../../plugins/superdroplets/coalescence.hpp"

namespace pileus::superdroplets {
namespace {

/// Superdroplets with all four columns; masses, dry and hygroscopic volumes 1, 10 and 100 times
/// the number of the droplet plus 1.
struct Droplets {
  std::vector<std::int64_t> multiplicity;
  std::vector<double> water_mass, dry_volume, hygroscopic_volume;
  std::vector<std::uint32_t> items;
  CoalescenceScratch scratch;

  explicit Droplets(std::vector<std::int64_t> of) : multiplicity(std::move(of)) {
    for (std::size_t i = 0; i < multiplicity.size(); ++i) {
      const auto x = static_cast<double>(i + 1);
      water_mass.push_back(x);
      dry_volume.push_back(10 * x);
      hygroscopic_volume.push_back(100 * x);
      items.push_back(static_cast<std::uint32_t>(i));
    }
  }
  /// Pairs coalesce `probability` times (for two droplets of larger multiplicity ξ: P = ξ·that).
  CoalescenceOutcome collide(double probability, const CoalescenceOptions& options,
                             std::uint64_t step = 0) {
    const DropColumns columns{multiplicity.data(), water_mass.data(), dry_volume.data(),
                              hygroscopic_volume.data()};
    return coalesce(ConstantKernel{probability}, columns, std::span<const std::uint32_t>(items),
                    1.0, 1.0, DrawKey{1, 2, 3, step}, options, scratch);
  }
};

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr CoalescenceOptions undivided{infinite, 1};

TEST(Coalescence, of_unequal_multiplicities_leaves_the_rest) {
  Droplets d({10, 3});
  const auto did = d.collide(0.2, undivided);  // P = 2: γ = 2
  EXPECT_EQ(d.multiplicity, (std::vector<std::int64_t>{4, 3}));
  EXPECT_EQ(d.water_mass, (std::vector<double>{1, 2 + 2 * 1}));
  EXPECT_EQ(d.dry_volume, (std::vector<double>{10, 20 + 2 * 10}));
  EXPECT_EQ(d.hygroscopic_volume, (std::vector<double>{100, 200 + 2 * 100}));
  EXPECT_EQ(did.coalescences, 6u);
  EXPECT_EQ(did.events, 1u);
  EXPECT_EQ(did.largest_repetition, 2);
  EXPECT_EQ(did.deficit, 0.0);
  EXPECT_EQ(did.substeps, 1);
}

TEST(Coalescence, is_limited_by_the_larger_multiplicity) {
  Droplets d({10, 3});
  const auto did = d.collide(1.0, undivided);  // P = 10, but 10 = 3·3 + 1
  EXPECT_EQ(d.multiplicity, (std::vector<std::int64_t>{1, 3}));
  EXPECT_EQ(d.water_mass, (std::vector<double>{1, 5}));
  EXPECT_EQ(did.deficit, (10.0 - 3.0) * 3.0);
}

TEST(Coalescence, divides_merged_drops_when_none_are_left_over) {
  Droplets even({6, 6}), odd({5, 5}), triple({15, 5});
  even.collide(1.0 / 6, undivided);
  EXPECT_EQ(even.multiplicity, (std::vector<std::int64_t>{3, 3}));
  EXPECT_EQ(even.water_mass, (std::vector<double>{3, 3}));
  EXPECT_EQ(even.dry_volume, (std::vector<double>{30, 30}));
  odd.collide(1.0 / 5, undivided);
  EXPECT_EQ(odd.multiplicity[0] + odd.multiplicity[1], 5);
  EXPECT_EQ(std::abs(odd.multiplicity[0] - odd.multiplicity[1]), 1);
  EXPECT_EQ(odd.hygroscopic_volume, (std::vector<double>{300, 300}));
  triple.collide(0.2, undivided);
  EXPECT_EQ(triple.multiplicity, (std::vector<std::int64_t>{2, 3}));
  EXPECT_EQ(triple.water_mass, (std::vector<double>{5, 5}));
}

TEST(Coalescence, of_two_single_drops_leaves_one_and_marks_the_other) {
  Droplets d({1, 1});
  const auto did = d.collide(1.0, undivided);
  EXPECT_EQ(d.multiplicity[0] + d.multiplicity[1], 1);
  EXPECT_EQ(d.multiplicity[0] * d.multiplicity[1], 0);
  EXPECT_EQ(d.water_mass, (std::vector<double>{3, 3}));
  EXPECT_EQ(did.emptied, 1u);
  EXPECT_EQ(did.coalescences, 1u);
  // The marked one never coalesces again.
  EXPECT_EQ(d.collide(1e12, {}).events, 0u);
}

TEST(Coalescence, needs_two_superdroplets_and_time) {
  Droplets none({}), one({7}), two({7, 7});
  EXPECT_EQ(none.collide(1e9, {}).substeps, 0);
  EXPECT_EQ(one.collide(1e9, {}).substeps, 0);
  EXPECT_EQ(one.multiplicity[0], 7);
  EXPECT_EQ(two.collide(0.0, {}).events, 0u);
  const DropColumns columns{two.multiplicity.data(), two.water_mass.data()};
  const std::span<const std::uint32_t> items(two.items);
  for (const double dt : {0.0, -1.0, std::nan("")})
    EXPECT_EQ(coalesce(ConstantKernel{1e9}, columns, items, 1, dt, {}, {}, two.scratch).events, 0u);
  for (const double volume : {0.0, -1.0, std::nan("")})
    EXPECT_EQ(coalesce(ConstantKernel{1e9}, columns, items, volume, 1, {}, {}, two.scratch).events,
              0u);
  EXPECT_EQ(two.multiplicity, (std::vector<std::int64_t>{7, 7}));
}

TEST(Coalescence, of_three_leaves_one_out_of_each_pairing) {
  Droplets d({8, 8, 8});
  const auto did = d.collide(1.0 / 24, undivided);  // n(n−1)/2 pairs over one: P = 3 ξ K = 1
  EXPECT_EQ(did.events, 1u);
  EXPECT_EQ(did.coalescences, 8u);
  EXPECT_EQ(d.multiplicity[0] + d.multiplicity[1] + d.multiplicity[2], 16);
}

TEST(Coalescence, survives_probabilities_and_multiplicities_of_any_size) {
  constexpr std::int64_t huge = std::int64_t{1} << 62;
  const std::vector<std::vector<std::int64_t>> cases = {
      {huge, huge}, {huge, 1}, {huge, huge - 1, 3, 1, 0}, {1, 1, 1, 1, 1, 1, 1}, {0, 0, 0}, {0, 5}};
  for (const auto& multiplicity : cases) {
    for (const double probability : {1e-300, 1e-30, 1e-6, 1.0, 1e12, 1e300, infinite}) {
      for (const CoalescenceOptions& options : {undivided, CoalescenceOptions{}}) {
        Droplets d(multiplicity);
        std::uint64_t before = 0, after = 0;
        for (const auto m : d.multiplicity) before += static_cast<std::uint64_t>(m);
        const auto did = d.collide(probability, options);
        std::uint64_t emptied = 0;
        for (std::size_t i = 0; i < d.multiplicity.size(); ++i) {
          EXPECT_GE(d.multiplicity[i], 0);
          EXPECT_TRUE(std::isfinite(d.water_mass[i]));
          emptied += d.multiplicity[i] == 0 && multiplicity[i] != 0 ? 1 : 0;
          after += static_cast<std::uint64_t>(d.multiplicity[i]);
        }
        EXPECT_EQ(before - after, did.coalescences);  // modulo 2^64, as documented
        EXPECT_EQ(emptied, did.emptied);
        EXPECT_FALSE(std::isnan(did.deficit));
        EXPECT_LE(did.substeps, 2 * options.most_substeps);
      }
    }
  }
}

TEST(Coalescence, treats_drops_without_water_as_drops) {
  Droplets d({100, 100, 100, 100});
  for (double& m : d.water_mass) m = 0;
  const FallSpeedTable table(FallSpeedScheme::beard_1976, 283.15, 9e4);
  const DropColumns columns{d.multiplicity.data(), d.water_mass.data()};
  const auto did = coalesce(TabulatedKernel{HallKernel{}, table}, columns,
                            std::span<const std::uint32_t>(d.items), 1e-30, 1e9, {}, {}, d.scratch);
  EXPECT_EQ(did.events, 0u);  // equal drops do not meet
}

TEST(Coalescence, divides_the_step_when_drops_would_run_short) {
  // P = 20 for a larger multiplicity of 10: undivided, half of the coalescences are missing.
  Droplets whole({10, 1, 10, 1, 10, 1}), divided({10, 1, 10, 1, 10, 1});
  EXPECT_GT(whole.collide(0.4, undivided).deficit, 0.0);
  CoalescenceOptions options;
  options.largest_change = infinite;
  options.most_substeps = 1000;
  const auto did = divided.collide(0.4, options);
  EXPECT_EQ(did.deficit, 0.0);
  EXPECT_GT(did.substeps, 1);
}

TEST(Coalescence, of_two_divides_the_step_whatever_the_draw) {
  for (std::uint64_t step = 0; step < 50; ++step) {
    Droplets d({1000000, 1000000});
    const double probability = 0.1;  // of a pair: the number falls by 5 %, ten times the bound
    EXPECT_EQ(d.collide(1e-6 * probability, {}, step).substeps, 10);
  }
}

TEST(DrawCoalescences, decides_by_the_word_and_then_by_further_digits) {
  const auto no_digits = [] {
    ADD_FAILURE() << "the word decides";
    return 0.5;
  };
  constexpr double range = 0x1p32;
  EXPECT_EQ(coalescence::draw_coalescences(2.5, 0, no_digits), 1.0);
  EXPECT_EQ(coalescence::draw_coalescences(2.5, 1, no_digits), 1.0);
  EXPECT_EQ(coalescence::draw_coalescences(2.5, 3, no_digits), 0.0);
  EXPECT_EQ(coalescence::draw_coalescences(2.5, 2, [] { return 0.49; }), 1.0);
  EXPECT_EQ(coalescence::draw_coalescences(2.5, 2, [] { return 0.51; }), 0.0);
  // Probabilities below 2^-32 are not lost: they are decided when the word is 0.
  EXPECT_EQ(coalescence::draw_coalescences(1e-3, 0, [] { return 0.9e-3; }), 1.0);
  EXPECT_EQ(coalescence::draw_coalescences(1e-3, 0, [] { return 1.1e-3; }), 0.0);
  EXPECT_EQ(coalescence::draw_coalescences(1e-3, 1, no_digits), 0.0);
  // Whole numbers are certain.
  EXPECT_EQ(coalescence::draw_coalescences(7.25 * range, 0x3FFFFFFFu, no_digits), 8.0);
  EXPECT_EQ(coalescence::draw_coalescences(7.25 * range, 0x40000000u, no_digits), 7.0);
  EXPECT_EQ(coalescence::draw_coalescences(7.0 * range, 0u, no_digits), 7.0);
  EXPECT_EQ(coalescence::draw_coalescences(1e20 * range, 0u, no_digits), 1e20);
  EXPECT_EQ(coalescence::draw_coalescences(0.0, 0u, no_digits), 0.0);
}

}  // namespace
}  // namespace pileus::superdroplets

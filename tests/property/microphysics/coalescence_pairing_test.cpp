// Who meets whom: every pair of superdroplets is as likely as every other, and a result depends on
// nothing but the key, the order of the items and the state.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "../../../plugins/superdroplets/coalescence.hpp"

namespace pileus::superdroplets {
namespace {

/// A kernel that writes down the pairs it is asked about (their masses number them) and lets
/// nothing coalesce.
struct Witness {
  std::vector<std::uint32_t>& met;
  std::size_t n;
  double operator()(double a, double b) const {
    const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
    ++met[std::min(i, k) * n + std::max(i, k)];
    return 0;
  }
};

/// Standard deviations by which χ² of the pairs' frequencies exceeds its expectation.
double excess(std::size_t n, std::uint64_t pairings) {
  std::vector<std::uint32_t> met(n * n), items(n);
  std::iota(items.begin(), items.end(), 0u);
  std::vector<std::int64_t> multiplicity(n, 1);
  std::vector<double> number(n);
  for (std::size_t i = 0; i < n; ++i) number[i] = static_cast<double>(i);
  CoalescenceScratch scratch;
  const CoalescenceOptions undivided{std::numeric_limits<double>::infinity(), 1};
  for (std::uint64_t step = 0; step < pairings; ++step) {
    coalesce(Witness{met, n}, DropColumns{multiplicity.data(), number.data()},
             std::span<const std::uint32_t>(items), 1.0, 1.0, DrawKey{11, 0, 5, step}, undivided,
             scratch);
  }
  const std::size_t at_once = n / 2;
  const double met_in_all = static_cast<double>(pairings) * static_cast<double>(at_once);
  const double pairs = static_cast<double>(n) * static_cast<double>(n - 1) / 2;
  const double expected = met_in_all / pairs;
  double chi_square = 0, seen = 0;
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_EQ(met[i * n + i], 0u);
    for (std::size_t k = i + 1; k < n; ++k) {
      const double difference = met[i * n + k] - expected;
      chi_square += difference * difference / expected;
      seen += met[i * n + k];
    }
  }
  EXPECT_EQ(seen, met_in_all);
  // Pairs of one pairing exclude each other, which lowers the variance a little.
  return (chi_square - (pairs - 1)) / std::sqrt(2 * (pairs - 1));
}

TEST(Pairing, meets_every_pair_equally_often) {
  EXPECT_LT(std::abs(excess(3, 30000)), 4);
  EXPECT_LT(std::abs(excess(4, 30000)), 4);
  EXPECT_LT(std::abs(excess(5, 30000)), 4);
  EXPECT_LT(std::abs(excess(6, 30000)), 4);
  EXPECT_LT(std::abs(excess(33, 20000)), 4);
  EXPECT_LT(std::abs(excess(200, 20000)), 4);
}

/// A cell whose superdroplets lie at positions given, in columns with others between them.
struct Scattered {
  std::vector<std::int64_t> multiplicity;
  std::vector<double> water_mass;
  std::vector<std::int64_t> items;

  Scattered(std::size_t n, std::size_t stride, std::size_t offset)
      : multiplicity(n * stride + offset, 77), water_mass(n * stride + offset, 5e-9) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t at = offset + (n - 1 - i) * stride;
      items.push_back(static_cast<std::int64_t>(at));
      multiplicity[at] = 1000 + static_cast<std::int64_t>(i % 7);
      water_mass[at] = 1e-12 * static_cast<double>(1 + i % 50);
    }
  }
  CoalescenceOutcome run(CoalescenceScratch& scratch, const DrawKey& key) {
    return coalesce(GolovinKernel{}, DropColumns{multiplicity.data(), water_mass.data()},
                    std::span<const std::int64_t>(items), 1e-9, 1.0, key, {}, scratch);
  }
};

TEST(Pairing, depends_on_the_order_of_items_not_on_where_they_are) {
  constexpr std::size_t n = 1001;
  const DrawKey key{1, 2, 3, 4, 5, 6};
  Scattered dense(n, 1, 0), sparse(n, 3, 11), other(n, 1, 0);
  CoalescenceScratch fresh, used, third;
  Scattered(5000, 1, 0).run(used, {9, 9, 9, 9, 9, 9});  // leaves its own traces in the room
  const auto a = dense.run(fresh, key), b = sparse.run(used, key);
  EXPECT_GT(a.events, 10u);
  EXPECT_EQ(a.events, b.events);
  EXPECT_EQ(a.coalescences, b.coalescences);
  EXPECT_EQ(a.substeps, b.substeps);
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = static_cast<std::size_t>(dense.items[i]),
               q = static_cast<std::size_t>(sparse.items[i]);
    EXPECT_EQ(dense.multiplicity[p], sparse.multiplicity[q]);
    EXPECT_EQ(dense.water_mass[p], sparse.water_mass[q]);
  }
  for (std::size_t q = 0; q < sparse.multiplicity.size(); ++q) {
    if ((q + 3 - 11 % 3) % 3 == 0 && q >= 11) continue;
    EXPECT_EQ(sparse.multiplicity[q], 77);  // bystanders
    EXPECT_EQ(sparse.water_mass[q], 5e-9);
  }
  other.run(third, {1, 2, 4, 4, 5, 6});  // another cell
  EXPECT_NE(other.water_mass, dense.water_mass);
}

TEST(Pairing, divided_steps_collide_as_often_as_they_should) {
  // Sixteen superdroplets of very different multiplicities: were a step divided by the very pairs
  // that are treated, those that collide most would get the least time. The expected loss of drops
  // is Σ ξ_i ξ_k K dt/ΔV over pairs, less some 2 % for what is lost within the step.
  constexpr std::size_t n = 16;
  CoalescenceScratch scratch;
  double lost = 0, expected = 0, substeps = 0;
  constexpr std::uint64_t members = 20000;
  for (std::uint64_t m = 0; m < members; ++m) {
    std::vector<std::int64_t> multiplicity(n);
    std::vector<double> mass(n, 1e-12);
    std::vector<std::uint32_t> items(n);
    std::iota(items.begin(), items.end(), 0u);
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < n; ++i) {
      multiplicity[i] = std::int64_t{1000} << i;
      const auto x = static_cast<double>(multiplicity[i]);
      sum += x;
      squares += x * x;
    }
    const double rate = 0.04 / sum;  // K dt/ΔV
    expected += 0.5 * (sum * sum - squares) * rate;
    const auto did =
        coalesce(ConstantKernel{rate}, DropColumns{multiplicity.data(), mass.data()},
                 std::span<const std::uint32_t>(items), 1.0, 1.0, DrawKey{3, 1, m}, {}, scratch);
    lost += static_cast<double>(did.coalescences);
    substeps += did.substeps;
  }
  EXPECT_GT(substeps / members, 2.0);
  EXPECT_NEAR(lost / expected, 0.98, 0.03);
}

}  // namespace
}  // namespace pileus::superdroplets

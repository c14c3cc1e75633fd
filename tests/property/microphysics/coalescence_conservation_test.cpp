// Random superdroplets of any multiplicity and size: numbers are kept to the last one, water, dry
// volume and hygroscopicity to rounding, whatever collides how often.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "../../../plugins/superdroplets/coalescence.hpp"

namespace pileus::superdroplets {
namespace {

struct Cell {
  std::vector<std::int64_t> multiplicity;
  std::vector<double> water_mass, dry_volume, hygroscopic_volume;
  std::vector<std::uint32_t> items;

  Cell(std::size_t n, std::mt19937_64& random) {
    const auto logarithmic = [&](double low, double high) {
      return std::exp(
          std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
    };
    const double most = logarithmic(1, 1e15);
    for (std::size_t i = 0; i < n; ++i) {
      multiplicity.push_back(static_cast<std::int64_t>(logarithmic(1, most)));
      water_mass.push_back(logarithmic(1e-18, 1e-8));
      dry_volume.push_back(logarithmic(1e-24, 1e-18));
      hygroscopic_volume.push_back(0.61 * dry_volume.back());
      items.push_back(static_cast<std::uint32_t>(i));
    }
    if (n > 3) multiplicity[n / 2] = 0;  // left by an earlier step
  }
  DropColumns columns() {
    return {multiplicity.data(), water_mass.data(), dry_volume.data(), hygroscopic_volume.data()};
  }
  std::uint64_t number() const {
    std::uint64_t sum = 0;
    for (const auto m : multiplicity) sum += static_cast<std::uint64_t>(m);
    return sum;
  }
  long double total(const std::vector<double>& carried) const {
    long double sum = 0;
    for (std::size_t i = 0; i < carried.size(); ++i)
      sum += static_cast<long double>(multiplicity[i]) * carried[i];
    return sum;
  }
};

template <class Kernel>
std::uint64_t expect_conservation(const Kernel& kernel, std::uint64_t trial,
                                  std::mt19937_64& random) {
  const std::size_t n = 2 + random() % 300;
  Cell cell(n, random);
  CoalescenceScratch scratch;
  // Air thin or thick enough for probabilities from 1e-3 to 1e3 of the typical pair.
  const double typical = static_cast<double>(cell.number()) * kernel(1e-12, 1e-10);
  const double volume =
      typical * std::pow(10.0, std::uniform_real_distribution<double>(-3, 3)(random));
  const std::uint64_t number = cell.number();
  const long double water = cell.total(cell.water_mass), dry = cell.total(cell.dry_volume),
                    hygroscopic = cell.total(cell.hygroscopic_volume);
  std::uint64_t coalescences = 0, events = 0, emptied = 0;
  for (std::uint64_t step = 0; step < 4; ++step) {
    CoalescenceOptions options;
    if (trial % 3 == 0) options = {1e300, 1};
    const auto did = coalesce(kernel, cell.columns(), std::span<const std::uint32_t>(cell.items),
                              volume, 1.0, DrawKey{trial, 0, 7, step}, options, scratch);
    coalescences += did.coalescences;
    events += did.events;
    emptied += did.emptied;
    EXPECT_GE(did.deficit, 0.0);
  }
  EXPECT_EQ(number - cell.number(), coalescences);
  // Each event rounds each of its two products once.
  const double rounding = 2.3e-16 * (4.0 + 2.0 * std::sqrt(static_cast<double>(events)));
  EXPECT_NEAR(static_cast<double>(cell.total(cell.water_mass) / water), 1.0, rounding);
  EXPECT_NEAR(static_cast<double>(cell.total(cell.dry_volume) / dry), 1.0, rounding);
  EXPECT_NEAR(static_cast<double>(cell.total(cell.hygroscopic_volume) / hygroscopic), 1.0,
              rounding);
  std::uint64_t empty = 0;
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_GE(cell.multiplicity[i], 0);
    EXPECT_TRUE(std::isfinite(cell.water_mass[i]));
    EXPECT_NEAR(cell.hygroscopic_volume[i] / cell.dry_volume[i], 0.61, 1e-11);
    empty += cell.multiplicity[i] == 0 ? 1 : 0;
  }
  EXPECT_EQ(empty, emptied + (n > 3 ? 1 : 0));
  return events;
}

TEST(Coalescence, conserves_over_a_hundred_thousand_random_events) {
  std::mt19937_64 random(20);
  const FallSpeedTable table(FallSpeedScheme::beard_1976, 283.15, 9e4);
  std::uint64_t events = 0;
  for (std::uint64_t trial = 0; events < 100000; ++trial) {
    events += expect_conservation(GolovinKernel{}, trial, random);
    events += expect_conservation(ConstantKernel{}, trial, random);
    events += expect_conservation(LongPolynomialKernel{}, trial, random);
    events += expect_conservation(TabulatedKernel{GeometricKernel{}, table}, trial, random);
    events += expect_conservation(TabulatedKernel{LongKernel{}, table}, trial, random);
    events += expect_conservation(TabulatedKernel{HallKernel{}, table}, trial, random);
    ASSERT_FALSE(::testing::Test::HasFailure()) << "trial " << trial;
  }
}

}  // namespace
}  // namespace pileus::superdroplets

// Lists of the parcels' items: copies, and how lists that are too long are shortened.
#include "parcels/item_lists.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "parcels/item_reduction.hpp"

namespace pileus::parcels {
namespace {

ItemLists lists_of(const std::vector<std::int32_t>& count,
                   const std::vector<std::int64_t>& multiplicity, const std::vector<double>& mass) {
  ItemLists lists({"number", {{"mass", "kg", ItemColumn::Kind::of_each, "", 0, 1e9}}});
  lists.start(count.size());
  lists.regroup(count, std::vector<std::int64_t>(multiplicity.size(), -1));
  std::copy(multiplicity.begin(), multiplicity.end(), lists.multiplicity());
  std::copy(mass.begin(), mass.end(), lists.column(0));
  return lists;
}

TEST(ItemLists, a_run_without_items_has_none) {
  const ItemLists none;
  EXPECT_FALSE(none.exist());
  EXPECT_EQ(none.size(), 0u);
}

TEST(ItemLists, new_items_are_zeros_and_copies_are_exact) {
  ItemLists lists = lists_of({2, 0, 1}, {5, 6, 7}, {0.5, 0.25, 0.125});
  lists.regroup(std::vector<std::int32_t>{1, 3}, std::vector<std::int64_t>{2, 0, -1, 0});
  ASSERT_EQ(lists.parcels(), 2u);
  ASSERT_EQ(lists.size(), 4u);
  EXPECT_EQ(lists.begin()[1], 1);
  EXPECT_EQ(lists.begin()[2], 4);
  const std::int64_t numbers[] = {7, 5, 0, 5};
  const double masses[] = {0.125, 0.5, 0.0, 0.5};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(lists.multiplicity()[i], numbers[i]);
    EXPECT_EQ(lists.column(0)[i], masses[i]);
  }
}

TEST(ItemReduction, unites_the_most_alike_and_keeps_the_sums) {
  // Ratios of neighbours: 1.01, 99, 1.001 and 2: the third pair first, then the first.
  ItemLists lists = lists_of({5}, {10, 20, 1000, 30, 1}, {1.0, 1.01, 100.0, 100.1, 200.0});
  std::vector<std::int64_t> items = {4, 2, 0, 1, 3};
  EXPECT_EQ(ItemReduction().run(lists, items, 3), 2u);
  EXPECT_EQ(lists.multiplicity()[0] + lists.multiplicity()[1], 30);
  EXPECT_EQ(lists.multiplicity()[2] + lists.multiplicity()[3], 1030);
  EXPECT_EQ(lists.multiplicity()[4], 1) << "the rare large one is not swallowed";
  EXPECT_EQ(lists.column(0)[4], 200.0);
  double amount = 0;
  for (int i = 0; i < 5; ++i)
    amount += static_cast<double>(lists.multiplicity()[i]) * lists.column(0)[i];
  EXPECT_NEAR(amount, 10 * 1.0 + 20 * 1.01 + 1000 * 100.0 + 30 * 100.1 + 200.0, 1e-10);
}

TEST(ItemReduction, leaves_short_lists_alone_and_ignores_empty_items) {
  ItemLists lists = lists_of({4}, {1, 0, 2, 0}, {1, 2, 3, 4});
  std::vector<std::int64_t> items = {0, 1, 2, 3};
  EXPECT_EQ(ItemReduction().run(lists, items, 2), 0u);
  EXPECT_EQ(lists.multiplicity()[0], 1);
  EXPECT_EQ(lists.multiplicity()[2], 2);
}

TEST(ItemReduction, of_equal_items_any_number_is_left) {
  const std::size_t count = 100;
  ItemLists lists =
      lists_of({100}, std::vector<std::int64_t>(count, 3), std::vector<double>(count, 0.1));
  std::vector<std::int64_t> items(count);
  std::iota(items.begin(), items.end(), 0);
  EXPECT_EQ(ItemReduction().run(lists, items, 7), 93u);
  std::int64_t sum = 0;
  int left = 0;
  for (std::size_t i = 0; i < count; ++i) {
    sum += lists.multiplicity()[i];
    left += lists.multiplicity()[i] > 0 ? 1 : 0;
    EXPECT_EQ(lists.column(0)[i], 0.1);
  }
  EXPECT_EQ(sum, 300);
  EXPECT_EQ(left, 7);
}

}  // namespace
}  // namespace pileus::parcels

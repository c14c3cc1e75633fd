#include "parcels/item_reduction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pileus::parcels {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Items of which only one has a property are as different as a factor of e^50 makes them.
constexpr double alone = 2500.0;

double squared_distance(const ItemLists& lists, std::int64_t a, std::int64_t b) {
  double sum = 0;
  for (std::size_t c = 0; c < lists.declaration().columns.size(); ++c) {
    if (lists.declaration().columns[c].kind != ItemColumn::Kind::of_each) continue;
    const double* x = lists.column(static_cast<int>(c));
    if (x[a] == x[b]) continue;
    const double log_ratio = x[a] > 0 && x[b] > 0 ? std::log(x[a] / x[b]) : std::sqrt(alone);
    sum += log_ratio * log_ratio;
  }
  return sum;
}

/// a takes up b: whole numbers add exactly, means stay between their parents.
void unite(ItemLists& lists, std::int64_t a, std::int64_t b) {
  std::int64_t* multiplicity = lists.multiplicity();
  const auto of_a = static_cast<double>(multiplicity[a]);
  const auto of_b = static_cast<double>(multiplicity[b]);
  const double inverse = 1.0 / (of_a + of_b);
  for (std::size_t c = 0; c < lists.declaration().columns.size(); ++c) {
    double* x = lists.column(static_cast<int>(c));
    const double mean = (of_a * x[a] + of_b * x[b]) * inverse;
    x[a] = std::clamp(mean, std::min(x[a], x[b]), std::max(x[a], x[b]));
  }
  multiplicity[a] += multiplicity[b];
  multiplicity[b] = 0;
}

}  // namespace

std::uint64_t ItemReduction::run(ItemLists& lists, std::vector<std::int64_t>& items,
                                 std::size_t most) {
  std::erase_if(items, [&](std::int64_t i) { return lists.multiplicity()[i] == 0; });
  if (items.size() <= most || lists.declaration().columns.empty()) return 0;
  const double* key = lists.column(0);
  std::stable_sort(items.begin(), items.end(),
                   [&](std::int64_t a, std::int64_t b) { return key[a] < key[b]; });
  // A chain of the items that are left; the pair to unite is looked for along it, so that n items
  // above the bound cost n walks: lists are as long as a few parcels' together.
  const std::size_t count = items.size();
  distance_.assign(count, infinity);
  next_.resize(count);
  previous_.resize(count);
  const auto measure = [&](std::size_t i) {
    distance_[i] = next_[i] < count ? squared_distance(lists, items[i], items[next_[i]]) : infinity;
  };
  for (std::size_t i = 0; i < count; ++i) {
    next_[i] = static_cast<std::uint32_t>(i + 1);
    previous_[i] = static_cast<std::uint32_t>(i == 0 ? count : i - 1);
  }
  for (std::size_t i = 0; i < count; ++i) measure(i);
  for (std::size_t left = count; left > most && left > 1; --left) {
    const auto closest = static_cast<std::size_t>(
        std::min_element(distance_.begin(), distance_.end()) - distance_.begin());
    const std::size_t gone = next_[closest];
    unite(lists, items[closest], items[gone]);
    next_[closest] = next_[gone];
    if (next_[gone] < count) previous_[next_[gone]] = static_cast<std::uint32_t>(closest);
    distance_[gone] = infinity;
    measure(closest);
    if (previous_[closest] < count) measure(previous_[closest]);
  }
  return count - std::max<std::size_t>(most, 1);
}

}  // namespace pileus::parcels

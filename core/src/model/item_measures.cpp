#include "model/item_measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "coupling/ledger.hpp"

namespace pileus::model {
namespace {

using coupling::CompensatedSum;

struct Moments {
  CompensatedSum sum, square;
  double high = 0;
};

Moments moments_of(const parcels::ItemLists& items, int column) {
  const std::int64_t* multiplicity = items.multiplicity();
  const double* x = items.column(column);
  return ordered_reduce(
      items.size(), Moments{},
      [&](std::size_t begin, std::size_t end) {
        Moments part;
        for (std::size_t i = begin; i < end; ++i) {
          const auto number = static_cast<double>(multiplicity[i]);
          part.sum.add(number * x[i]);
          part.square.add(number * (x[i] * x[i]));
          if (multiplicity[i] > 0) part.high = std::max(part.high, x[i]);
        }
        return part;
      },
      [](Moments a, const Moments& b) {
        a.sum.add(b.sum.value());
        a.square.add(b.square.value());
        a.high = std::max(a.high, b.high);
        return a;
      });
}

/// Exact until it is rounded once: multiplicities may add up to more than 64 bits hold.
double total_of(const std::int64_t* multiplicity, std::size_t count) {
  constexpr int low_bits = 31;
  struct Parts {
    std::int64_t high = 0, low = 0;
  };
  const Parts total = ordered_reduce(
      count, Parts{},
      [&](std::size_t begin, std::size_t end) {
        Parts part;
        for (std::size_t i = begin; i < end; ++i) {
          part.high += multiplicity[i] >> low_bits;
          part.low += multiplicity[i] & ((std::int64_t{1} << low_bits) - 1);
        }
        return part;
      },
      [](const Parts& a, const Parts& b) {
        return Parts{a.high + b.high, a.low + b.low};
      });
  const std::int64_t carry = total.low >> low_bits;
  return std::ldexp(static_cast<double>(total.high + carry), low_bits) +
         static_cast<double>(total.low - (carry << low_bits));
}

}  // namespace

ItemMeasures::ItemMeasures(const parcels::ItemLists& items) {
  if (!items.exist()) return;
  const parcels::ItemDeclaration& declared = items.declaration();
  outputs_.push_back({"items", "1", "number of items of all parcels"});
  outputs_.push_back(
      {"total_" + declared.multiplicity, "1", "number of things the items stand for"});
  for (std::size_t c = 0; c < declared.columns.size(); ++c) {
    const parcels::ItemColumn& column = declared.columns[c];
    if (column.kind != parcels::ItemColumn::Kind::of_each) continue;
    columns_.push_back(static_cast<int>(c));
    outputs_.push_back({"total_" + column.name, column.units, "sum over all things"});
    outputs_.push_back({"second_moment_of_" + column.name, fmt::format("({})2", column.units),
                        "sum of squares over all things"});
    outputs_.push_back({"max_" + column.name, column.units, "largest of a thing"});
  }
}

std::vector<double> ItemMeasures::measure(const parcels::ItemLists& items) const {
  if (outputs_.empty()) return {};
  const std::int64_t* multiplicity = items.multiplicity();
  const double number = total_of(multiplicity, items.size());
  const auto some = std::count_if(multiplicity, multiplicity + items.size(),
                                  [](std::int64_t n) { return n > 0; });
  std::vector<double> values = {static_cast<double>(some), number};
  for (const int column : columns_) {
    const Moments moments = moments_of(items, column);
    values.insert(values.end(), {moments.sum.value(), moments.square.value(), moments.high});
  }
  return values;
}

double budget_of_items(const parcels::ItemLists& items, const std::string& budget) {
  double total = 0;
  for (std::size_t c = 0; c < items.declaration().columns.size(); ++c)
    if (items.declaration().columns[c].budget == budget)
      total += moments_of(items, static_cast<int>(c)).sum.value() / items.budget_scale();
  return total;
}

}  // namespace pileus::model

#include "output/item_file.hpp"

#include <bit>
#include <cmath>
#include <utility>

#include "parcels/identity.hpp"

namespace pileus::output {
namespace {

RaggedContent content_of(const parcels::Store& store, std::vector<Variable> descriptions) {
  RaggedContent content;
  content.group = "droplets";
  content.counted = "number of items of the record";
  content.wholes = {{"parcel_uid", "1", "identity of the parcel that owns the item"},
                    descriptions.front()};
  content.positions = position_variables(store.dimension(), "the item, sideways of its parcel");
  content.columns.assign(descriptions.begin() + 1, descriptions.end());
  return content;
}

/// A number of [0, 1) that belongs to an item at a time.
double lot(std::uint64_t uid, std::int64_t place, double time) {
  const std::uint64_t when = parcels::mix(std::bit_cast<std::uint64_t>(time) + 1);
  const std::uint64_t bits =
      parcels::mix(uid ^ parcels::mix(static_cast<std::uint64_t>(place) ^ when));
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace

std::vector<Variable> item_variables(const parcels::ItemLists& items) {
  std::vector<Variable> variables = {{items.declaration().multiplicity, "1", ""}};
  for (const parcels::ItemColumn& column : items.declaration().columns)
    variables.push_back({column.name, column.units, ""});
  return variables;
}

ItemFile::ItemFile(std::filesystem::path path, const parcels::Store& store,
                   std::vector<Variable> descriptions, double fraction, Provenance provenance,
                   Encoding encoding, Start start)
    : RaggedFile(std::move(path), content_of(store, std::move(descriptions)), std::move(provenance),
                 encoding, start),
      fraction_(fraction) {}

void ItemFile::collect(double time, const parcels::Store& store) {
  const parcels::ItemLists& items = store.items();
  const int vertical = store.dimension() - 1;
  const double* height = items.height_column() >= 0 ? items.column(items.height_column()) : nullptr;
  parcel_.clear();
  multiplicity_.clear();
  positions_.assign(content().positions.size(), {});
  columns_.assign(content().columns.size(), {});
  for (std::size_t p = 0; p < store.size(); ++p)
    for (std::int64_t k = 0; k < items.count()[p]; ++k) {
      const std::int64_t i = items.begin()[p] + k;
      if (items.multiplicity()[i] == 0 || !(lot(store.uid()[p], k, time) < fraction_)) continue;
      parcel_.push_back(store.uid()[p]);
      multiplicity_.push_back(static_cast<std::uint64_t>(items.multiplicity()[i]));
      for (int d = 0; d <= vertical; ++d) {
        double x = store.position(d)[p];
        if (d == vertical && height != nullptr)
          x += height[i] * std::sqrt(store.shape(store.shape_components() - 1)[p]);
        positions_[static_cast<std::size_t>(d)].push_back(x);
      }
      for (std::size_t c = 0; c < columns_.size(); ++c)
        columns_[c].push_back(items.column(static_cast<int>(c))[i]);
    }
}

void ItemFile::append(double time, const parcels::Store& store) {
  collect(time, store);
  RaggedRecord record;
  record.size = parcel_.size();
  record.wholes = {parcel_.data(), multiplicity_.data()};
  for (const auto& values : positions_) record.positions.push_back(values.data());
  for (const auto& values : columns_) record.columns.push_back(values.data());
  RaggedFile::append(time, record);
}

}  // namespace pileus::output

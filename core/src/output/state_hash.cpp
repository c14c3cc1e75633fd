#include "output/state_hash.hpp"

#include <bit>
#include <string_view>

#include "base/sha256.hpp"

namespace pileus::output {

static_assert(std::endian::native == std::endian::little, "digests are of little-endian numbers");

namespace {

class StateMessage {
 public:
  void integer(std::uint64_t value) { hash_.update(&value, sizeof value); }
  void real(double value) { hash_.update(&value, sizeof value); }
  void text(std::string_view value) {
    integer(value.size());
    hash_.update(value);
  }
  void bytes(const void* data, std::size_t count) { hash_.update(data, count); }
  std::string finish() { return hash_.finish_hex(); }

 private:
  Sha256 hash_;
};

/// Nothing in a run without items: their state has the digest it always had.
void add_items(const parcels::ItemLists& items, StateMessage& message) {
  if (!items.exist()) return;
  message.text(items.declaration().multiplicity);
  message.integer(items.size());
  message.bytes(items.count(), items.parcels() * sizeof(std::int32_t));
  message.bytes(items.multiplicity(), items.size() * sizeof(std::int64_t));
  for (std::size_t c = 0; c < items.declaration().columns.size(); ++c) {
    message.text(items.declaration().columns[c].name);
    message.bytes(items.column(static_cast<int>(c)), items.size() * sizeof(double));
  }
}

}  // namespace

std::string state_sha256(const parcels::Store& store, double time, std::uint64_t step,
                         const std::map<std::string, std::vector<double>>& extra) {
  StateMessage message;
  message.text("pileus state 1");
  message.real(time);
  message.integer(step);
  message.integer(static_cast<std::uint64_t>(store.dimension()));
  message.integer(store.size());
  message.bytes(store.uid(), store.size() * sizeof(std::uint64_t));
  for (int column = 0; column < store.state_columns(); ++column) {
    message.text(store.column_name(column));
    message.bytes(store.column(column), store.size() * sizeof(double));
  }
  add_items(store.items(), message);
  for (const auto& [name, values] : extra) {
    message.text(name);
    message.integer(values.size());
    message.bytes(values.data(), values.size() * sizeof(double));
  }
  return message.finish();
}

}  // namespace pileus::output

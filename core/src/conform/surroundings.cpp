#include "conform/surroundings.hpp"

#include <algorithm>
#include <string_view>

#include "coupling/quantity_plan.hpp"
#include "mesh/flow_quantities.hpp"

namespace pileus::conform {
namespace {

bool belongs_to_items(const pileus_quantity& row) {
  return row.place == PILEUS_ITEM;
}
bool makes(const pileus_quantity& row) {
  return (row.access & PILEUS_CREATE) != 0;
}

/// What the subject only reads or changes, from the side of its owner.
pileus_quantity owned(const pileus_quantity& row, const char* multiplicity) {
  pileus_quantity mine = row;
  mine.access = PILEUS_READ | PILEUS_WRITE | PILEUS_CREATE;
  mine.when = nullptr;
  mine.budget = nullptr;
  mine.initial = std::clamp(0.0, row.low, row.high);
  if (!belongs_to_items(row)) return mine;
  if (row.type == PILEUS_I64) {
    mine.nature = PILEUS_EXTENSIVE;
  } else if (std::string_view(row.name) == coupling::height_within_parcel_name) {
    mine.nature = PILEUS_LABEL;
  } else {
    mine.nature = PILEUS_INTENSIVE;
    mine.weight = multiplicity;
  }
  return mine;
}

pileus_operator stand_in_operator() {
  pileus_operator op{};
  op.size = sizeof op;
  op.scope = PILEUS_GLOBAL;
  op.form = PILEUS_FLOW;
  op.id = "org.pileus.stand_in";
  op.kind = "surface";
  op.version = "1.0.0";
  op.create = [](const pileus_host*, void** self, pileus_error*) {
    *self = nullptr;
    return pileus_status{PILEUS_OK};
  };
  op.configure = [](void*, const pileus_values*, pileus_error*) {
    return pileus_status{PILEUS_OK};
  };
  op.apply = [](void*, const pileus_step*, const pileus_block*, pileus_error*) {
    return pileus_status{PILEUS_OK};
  };
  op.destroy = [](void*) {};
  return op;
}

}  // namespace

Surroundings::Surroundings(const Case& subject, host::ParameterValues values) {
  entries_.push_back({"subject", subject.table, std::move(values), 0, {}});
  add_maker(subject);
  add_stand_in();
}

/// Another operator of the library that makes items of the names the subject knows.
void Surroundings::add_maker(const Case& subject) {
  const auto wanted = [&](const pileus_quantity& made) {
    return belongs_to_items(made) && makes(made) && made.type == PILEUS_I64 &&
           std::any_of(subject.table->quantities.begin(), subject.table->quantities.end(),
                       [&](const pileus_quantity& row) {
                         return belongs_to_items(row) && !makes(row) &&
                                std::string_view(row.name) == made.name;
                       });
  };
  for (const host::OperatorTable& table : subject.library->operators) {
    if (std::none_of(table.quantities.begin(), table.quantities.end(), wanted)) continue;
    auto maker = std::make_shared<const host::OperatorTable>(table);
    entries_.push_back({"maker", maker, host::ParameterValues(*maker), 0, {}});
    return;
  }
}

bool Surroundings::is_provided(const pileus_quantity& wanted) const {
  for (const coupling::OperatorEntry& entry : entries_)
    for (std::size_t i = 0; i < entry.table->quantities.size(); ++i) {
      const pileus_quantity& row = entry.table->quantities[i];
      const bool provides =
          makes(row) || (row.place == PILEUS_SURFACE && (row.access & PILEUS_ADD) != 0);
      if (provides && row.place == wanted.place && entry.exists(i) &&
          std::string_view(row.name) == wanted.name)
        return true;
    }
  return false;
}

void Surroundings::add_stand_in() {
  const coupling::OperatorEntry& subject = entries_.front();
  auto table = std::make_shared<host::OperatorTable>();
  table->op = stand_in_operator();
  const char* multiplicity = nullptr;
  for (const pileus_quantity& row : subject.table->quantities)
    if (belongs_to_items(row) && row.type == PILEUS_I64) multiplicity = row.name;
  for (std::size_t i = 0; i < subject.table->quantities.size(); ++i) {
    const pileus_quantity& row = subject.table->quantities[i];
    if (!belongs_to_items(row) && row.place != PILEUS_SURFACE) continue;
    if (!subject.exists(i) || is_provided(row)) continue;
    table->quantities.push_back(owned(row, multiplicity));
    table->quantity_when.emplace_back();
    stands_in_for_maker_ |= belongs_to_items(row) && row.type == PILEUS_I64;
  }
  if (table->quantities.empty()) return;
  entries_.push_back({"stand_in", table, host::ParameterValues(*table), 0, {}});
}

std::vector<std::string> Surroundings::initial() const {
  std::vector<std::string> names;
  std::vector<std::string_view> derived;
  for (const coupling::OperatorEntry& entry : entries_)
    for (const pileus_quantity& row : entry.table->quantities)
      if (row.nature == PILEUS_DERIVED) derived.emplace_back(row.name);
  for (const coupling::OperatorEntry& entry : entries_)
    for (std::size_t i = 0; i < entry.table->quantities.size(); ++i) {
      const pileus_quantity& row = entry.table->quantities[i];
      const bool of_parcels = row.place == PILEUS_PARCEL ||
                              ((row.place == PILEUS_MESH || row.place == PILEUS_MESH_AT_PARCEL) &&
                               !mesh::is_flow_quantity(row.name));
      if (!of_parcels || coupling::is_core_quantity(row.name) || !entry.exists(i)) continue;
      if (std::find(derived.begin(), derived.end(), row.name) != derived.end()) continue;
      if (std::find(names.begin(), names.end(), row.name) == names.end())
        names.emplace_back(row.name);
    }
  return names;
}

}  // namespace pileus::conform

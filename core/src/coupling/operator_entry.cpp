#include "coupling/operator_entry.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "coupling/parameters.hpp"
#include "host/library.hpp"
#include "scene/value.hpp"

namespace pileus::coupling {
namespace {

bool is_path(const std::string& use) {
  return use.find('/') != std::string::npos || use.ends_with(".so");
}

/// The operator with the id `use`; a library named by path must hold exactly one.
std::shared_ptr<const host::OperatorTable> choose(host::Library library, const std::string& use) {
  std::vector<std::string> ids;
  for (host::OperatorTable& table : library.operators) {
    ids.emplace_back(table.op.id);
    if (ids.back() == use || (is_path(use) && library.operators.size() == 1)) {
      return std::make_shared<const host::OperatorTable>(std::move(table));
    }
  }
  const std::string nearest = nearest_word(use, ids);
  throw Error(ExitCode::plugin,
              fmt::format("the plugin library '{}' holds no operator '{}'; it holds {}{}",
                          library.path.string(), use, scene::alternatives(ids),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

int read_substeps(const scene::OperatorBlock& block, scene::Problems& problems) {
  for (const auto& [key, raw] : block.parameters) {
    if (key != substeps_key || (!raw.is_list && raw.text == "auto")) continue;
    const auto number = raw.is_list ? std::nullopt : scene::read_integer(raw.text);
    if (number && *number >= 1 && *number <= most_substeps) return static_cast<int>(*number);
    problems.add(raw.where,
                 fmt::format("'substeps' is 'auto' or a whole number from 1 to {}", most_substeps),
                 static_cast<int>(raw.text.size()));
  }
  return 0;
}

/// Whether a quantity's `when` holds with watched effects on or off.
bool holds_with(const OperatorEntry& entry, std::size_t quantity, bool watched) {
  std::vector<std::uint8_t> on;
  for (const EffectState state : entry.effects)
    on.push_back(state == EffectState::on || (watched && state == EffectState::watched) ? 1 : 0);
  return host::holds(entry.table->quantity_when[quantity], entry.values.numbers(),
                     on.empty() ? nullptr : on.data());
}

}  // namespace

bool OperatorEntry::exists(std::size_t quantity) const {
  return holds_with(*this, quantity, true);
}

bool OperatorEntry::hands_over(std::size_t quantity) const {
  return holds_with(*this, quantity, false);
}

bool OperatorEntry::is_dormant() const {
  bool any = false;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (table->effects[i].role != PILEUS_PROVIDES) continue;
    if (effects[i] == EffectState::on) return false;
    any = any || effects[i] == EffectState::watched;
  }
  return any;
}

bool writes_at_the_ground(const std::vector<OperatorEntry>& operators, std::string_view quantity) {
  return std::any_of(operators.begin(), operators.end(), [&](const OperatorEntry& entry) {
    const host::OperatorTable& table = *entry.table;
    const int row = table.find_quantity(quantity);
    if (row < 0 || table.op.kind != std::string_view("surface")) return false;
    const auto slot = static_cast<std::size_t>(row);
    return entry.exists(slot) && (table.quantities[slot].access & PILEUS_WRITE) != 0;
  });
}

std::vector<OperatorEntry> load_operators(const scene::Scene& scene, const host::SearchPath& search,
                                          scene::Problems& problems) {
  std::vector<OperatorEntry> entries;
  for (const scene::OperatorBlock& block : scene.operators) {
    const std::filesystem::path path = host::find_library(block.use, search);
    auto table = choose(host::load_library(path), block.use);
    host::ParameterValues values = read_parameters(block, *table, scene, problems);
    std::string name = block.name.empty() ? std::string(table->op.id) : block.name;
    const int substeps = read_substeps(block, problems);
    entries.push_back({std::move(name), std::move(table), std::move(values), substeps, {}});
  }
  return entries;
}

}  // namespace pileus::coupling

// Checks of what an operator declares: C04, C05 and C06.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

#include "base/error.hpp"
#include "base/quantities.hpp"
#include "base/units.hpp"
#include "conform/check.hpp"
#include "conform/surroundings.hpp"
#include "coupling/quantity_plan.hpp"
#include "host/row_rules.hpp"

namespace pileus::conform {
namespace {

/// Licences in use for scientific code; others are written LicenseRef-… (SPDX 2.3, annex D).
constexpr std::array<std::string_view, 24> licences = {"Apache-2.0",
                                                       "MIT",
                                                       "BSD-2-Clause",
                                                       "BSD-3-Clause",
                                                       "ISC",
                                                       "Zlib",
                                                       "BSL-1.0",
                                                       "MPL-2.0",
                                                       "Unlicense",
                                                       "CC0-1.0",
                                                       "CC-BY-4.0",
                                                       "EUPL-1.2",
                                                       "CECILL-2.1",
                                                       "CECILL-B",
                                                       "CECILL-C",
                                                       "GPL-2.0-only",
                                                       "GPL-2.0-or-later",
                                                       "GPL-3.0-only",
                                                       "GPL-3.0-or-later",
                                                       "LGPL-2.1-or-later",
                                                       "LGPL-3.0-only",
                                                       "LGPL-3.0-or-later",
                                                       "AGPL-3.0-only",
                                                       "AGPL-3.0-or-later"};

bool is_licence(std::string_view word) {
  return word.starts_with("LicenseRef-") ||
         std::find(licences.begin(), licences.end(), word) != licences.end();
}

/// Licences joined by AND, OR, with parentheses; what follows WITH is an exception.
void check_licence(std::string_view text) {
  std::string word;
  bool exception = false;
  const auto end_word = [&] {
    if (word.empty() || word == "AND" || word == "OR") {
    } else if (word == "WITH") {
      exception = true;
    } else if (!exception && !is_licence(word)) {
      fail(
          fmt::format("the licence '{}' is no known SPDX identifier; write for example "
                      "Apache-2.0, GPL-3.0-or-later or LicenseRef-…",
                      word));
    } else {
      exception = false;
    }
    word.clear();
  };
  for (const char c : text) {
    const bool part =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.' || c == '+';
    if (part)
      word += c;
    else
      end_word();
  }
  end_word();
}

/// One sentence ends in the only full stop that is followed by a space and a capital, or by
/// nothing.
void check_sentence(std::string_view summary) {
  if (!summary.ends_with('.')) fail("the summary does not end with a full stop");
  for (std::size_t at = 0; at + 2 < summary.size(); ++at)
    if (summary[at] == '.' && summary[at + 1] == ' ' &&
        std::isupper(static_cast<unsigned char>(summary[at + 2])) != 0)
      fail("the summary is more than one sentence");
}

void check_quantity_row(const pileus_quantity& row) {
  const Quantity* known = find_quantity(row.name);
  if (known == nullptr) {
    if (coupling::is_core_quantity(row.name)) return;
    const std::string nearest = nearest_quantity(row.name);
    fail(fmt::format("the quantity '{}' is not registered{}", row.name,
                     nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  if (known->units != row.units)
    fail(fmt::format("'{}' is declared in '{}', registered is '{}'", row.name, row.units,
                     known->units));
}

void check_parameter_row(const pileus_parameter& p) {
  if (!is_unit(p.units))
    fail(fmt::format("the parameter '{}' has the unit '{}', which nobody knows", p.name, p.units));
  if (p.ladder == nullptr || p.low >= p.high) return;
  for (const double* value = p.ladder; !std::isnan(*value); ++value)
    if (*value < p.low || *value > p.high)
      fail(fmt::format("the ladder of '{}' leaves its range at {:g}", p.name, *value));
}

}  // namespace

std::string check_names_and_units(const Case& c) {
  for (const pileus_quantity& row : c.table->quantities) check_quantity_row(row);
  for (const pileus_parameter& row : c.table->parameters) check_parameter_row(row);
  return {};
}

std::string check_natures_and_budgets(const Case& c) {
  for (const std::string& budget : c.table->budgets)
    if (!host::is_identifier(budget))
      fail(fmt::format("the budget '{}' is not of lower-case words joined by underscores", budget));
  for (const pileus_quantity& row : c.table->quantities) {
    const bool item = row.place == PILEUS_ITEM;
    if (row.nature != PILEUS_INTENSIVE || item) continue;
    if (std::string_view(row.weight) != coupling::volume_name)
      fail(fmt::format("'{}' is weighted by '{}'; parcels are weighted by '{}'", row.name,
                       row.weight, coupling::volume_name));
  }
  try {
    check_names_and_units(c);  // what is wrong there is told there
  } catch (const Finding&) {
    return {};
  }
  try {
    const Surroundings around(c, host::ParameterValues(*c.table));
    coupling::plan_quantities(around.entries(), around.initial());
  } catch (const Error& error) {
    fail(fmt::format("it cannot be planned: {}", error.what()));
  }
  return {};
}

std::string check_metadata(const Case& c) {
  check_licence(c.op().licence);
  check_sentence(c.op().summary);
  if (c.table->references.empty())
    fail(
        "it cites nothing; where there is nothing to cite, say so: cites(nullptr, \"no "
        "reference: …\")");
  for (const pileus_reference& row : c.table->references) {
    if (row.text == nullptr || *row.text == '\0') fail("a reference has no text");
    if (row.doi != nullptr && *row.doi != '\0' && !std::string_view(row.doi).starts_with("10."))
      fail(fmt::format("the DOI '{}' does not begin with 10.", row.doi));
  }
  return {};
}

}  // namespace pileus::conform

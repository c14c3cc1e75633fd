// The operators a scene names: found, loaded, their parameters checked.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/operator_table.hpp"
#include "host/parameter_values.hpp"
#include "host/search.hpp"
#include "scene/problems.hpp"
#include "scene/scene.hpp"

namespace pileus::coupling {

/// Key of an operator's block that the coupling reads: `auto` or a number of sub-steps.
inline constexpr const char* substeps_key = "substeps";
/// Most sub-steps per call: 64, so that with the sixteen numbers of the retry tree each call of a
/// step has its own ten bits in the keys of random numbers.
inline constexpr int most_substeps = 64;

/// What the plan says about an effect that an operator provides.
enum class EffectState : std::uint8_t {
  off,  // its quantities do not exist
  on,
  watched,  // its quantities exist but are not handed over until it is switched on
};

/// One operator of a scene.
struct OperatorEntry {
  std::string name;  // label in order, plan and ledger
  std::shared_ptr<const host::OperatorTable> table;
  host::ParameterValues values;
  int substeps = 0;                       // 0: as many as its own step limit asks for
  std::vector<EffectState> effects = {};  // one per row of table->effects; empty: all on

  /// Whether a declared quantity exists in this run.
  bool exists(std::size_t quantity) const;
  /// Whether the plugin is given it at present.
  bool hands_over(std::size_t quantity) const;
  /// Whether all effects it provides wait to be switched on, so that it is not called.
  bool is_dormant() const;
};

/// Whether one of the kind "surface" may change a quantity of the parcels.
bool writes_at_the_ground(const std::vector<OperatorEntry>& operators, std::string_view quantity);

/// Loads every operator of the scene. Mistakes in the scene go to `problems`, all of them; an
/// operator with a mistake in its parameters is still returned.
///
/// Errors  Error(ExitCode::plugin) for a library that is missing or refused
std::vector<OperatorEntry> load_operators(const scene::Scene& scene, const host::SearchPath& search,
                                          scene::Problems& problems);

}  // namespace pileus::coupling

// The scene's expectations against what a run measured.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "output/summary.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// The value of a diagnostic's series at a simulated time (s); nothing when the run has none.
using SeriesValue =
    std::function<std::optional<double>(const std::string& diagnostic, double time)>;

/// Refuses expectations of diagnostics that a run will not measure, before it starts: throws
/// Error(usage) naming the place in the scene and the nearest name that exists.
void require_diagnostics(const std::vector<scene::Expectation>& expectations,
                         const std::vector<std::string>& measured);

/// Judges every expectation, in order. Bounds are inclusive. A value that is missing or not finite
/// fails. Where the summary has no relative change of its own, (final − initial)/|initial| is it.
std::vector<output::ExpectSummary> judge(const std::vector<scene::Expectation>& expectations,
                                         const std::vector<output::DiagnosticSummary>& diagnostics,
                                         const SeriesValue& series);

bool all_passed(const std::vector<output::ExpectSummary>& judged);

}  // namespace pileus::model

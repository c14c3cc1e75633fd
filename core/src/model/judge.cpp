#include "model/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/nearest_word.hpp"

namespace pileus::model {

namespace {

double statistic_of(const output::DiagnosticSummary& diagnostic, const std::string& statistic) {
  if (statistic == "initial") return diagnostic.initial;
  if (statistic == "final") return diagnostic.final;
  if (statistic == "min") return diagnostic.min;
  if (statistic == "max") return diagnostic.max;
  if (statistic == "mean") return diagnostic.mean;
  if (statistic == "relative_change") {
    return diagnostic.relative_change.value_or((diagnostic.final - diagnostic.initial) /
                                               std::abs(diagnostic.initial));
  }
  return output::not_available;
}

double value_of(const scene::Expectation& expectation,
                const std::vector<output::DiagnosticSummary>& diagnostics,
                const SeriesValue& series) {
  if (expectation.at) {
    return series(expectation.diagnostic, *expectation.at).value_or(output::not_available);
  }
  const auto found = std::find_if(
      diagnostics.begin(), diagnostics.end(),
      [&](const auto& diagnostic) { return diagnostic.name == expectation.diagnostic; });
  return found == diagnostics.end() ? output::not_available
                                    : statistic_of(*found, expectation.statistic);
}

}  // namespace

void require_diagnostics(const std::vector<scene::Expectation>& expectations,
                         const std::vector<std::string>& measured) {
  std::string message;
  for (const scene::Expectation& expectation : expectations) {
    if (std::find(measured.begin(), measured.end(), expectation.diagnostic) != measured.end()) {
      continue;
    }
    const scene::Location& where = expectation.where;
    const std::string nearest = nearest_word(expectation.diagnostic, measured);
    message += fmt::format("{}{}:{}:{}: error: this scene has no diagnostic '{}'{}",
                           message.empty() ? "" : "\n", where.file, where.line, where.column,
                           expectation.diagnostic,
                           nearest.empty() ? fmt::format("; it has {}", fmt::join(measured, ", "))
                                           : fmt::format("; did you mean '{}'?", nearest));
  }
  if (!message.empty()) throw Error(ExitCode::usage, message);
}

std::vector<output::ExpectSummary> judge(const std::vector<scene::Expectation>& expectations,
                                         const std::vector<output::DiagnosticSummary>& diagnostics,
                                         const SeriesValue& series) {
  std::vector<output::ExpectSummary> judged;
  judged.reserve(expectations.size());
  for (const scene::Expectation& expectation : expectations) {
    output::ExpectSummary& result = judged.emplace_back();
    result.diagnostic = expectation.diagnostic;
    result.statistic = expectation.statistic;
    result.at = expectation.at;
    result.low = expectation.low;
    result.high = expectation.high;
    result.source = expectation.source;
    result.value = value_of(expectation, diagnostics, series);
    result.passed = std::isfinite(result.value) && (!result.low || result.value >= *result.low) &&
                    (!result.high || result.value <= *result.high);
  }
  return judged;
}

bool all_passed(const std::vector<output::ExpectSummary>& judged) {
  return std::all_of(judged.begin(), judged.end(), [](const auto& each) { return each.passed; });
}

}  // namespace pileus::model

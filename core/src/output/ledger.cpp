// The end-of-run table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/terminal.hpp"
#include "base/wrap_text.hpp"
#include "output/summary.hpp"

namespace pileus::output {

namespace {

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : std::string("n/a");
}

std::string bytes(double count) {
  constexpr const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  while (count >= 1024 && unit + 1 < std::size(units)) {
    count /= 1024;
    ++unit;
  }
  return fmt::format("{:.{}f} {}", count, unit == 0 ? 0 : 1, units[unit]);
}

std::string headline(const Summary& s) {
  const char* what = s.status == Summary::Status::done      ? "done"
                     : s.status == Summary::Status::stopped ? "stopped"
                                                            : "failed";
  std::string text = fmt::format("{}: {} at {} s after {} steps, {} of wall time, {} thread{}\n",
                                 s.scene, what, number(s.simulated_time), format_count(s.steps),
                                 format_duration(s.wall), s.threads, s.threads == 1 ? "" : "s");
  if (!s.message.empty()) text += "  " + s.message + "\n";
  text += fmt::format("  parcels {} -> {}", format_count(s.parcels_initial),
                      format_count(s.parcels_final));
  if (std::isfinite(s.ns_per_parcel_step))
    text += fmt::format(", {:.0f} ns of one core per parcel-step", s.ns_per_parcel_step);
  if (std::isfinite(s.bytes_per_parcel))
    text += fmt::format(", {:.0f} bytes per parcel", s.bytes_per_parcel);
  return text + fmt::format(", peak memory {}\n", bytes(static_cast<double>(s.peak_memory)));
}

std::string phase_table(const Summary& s) {
  std::vector<PhaseSummary> phases = s.phases;
  std::erase_if(phases, [](const PhaseSummary& phase) { return phase.calls == 0; });
  if (phases.empty()) return {};
  std::stable_sort(phases.begin(), phases.end(), [](const PhaseSummary& a, const PhaseSummary& b) {
    return a.seconds > b.seconds;
  });
  std::string text =
      fmt::format("\n  {:<28}{:>12}{:>9}{:>12}\n", "phase", "seconds", "share", "calls");
  for (const PhaseSummary& phase : phases)
    text += fmt::format("  {:<28}{:>12.3f}{:>7.1f} %{:>12}\n", phase.name, phase.seconds,
                        100 * phase.share, format_count(phase.calls));
  return text;
}

std::string saved(double seconds) {
  return std::isfinite(seconds) ? fmt::format("{:.3f}", seconds) : std::string("n/a");
}

/// Cost and calls, as the columns that operators and effects have in common.
std::string call_columns(const CallSummary& one) {
  return fmt::format("{:>9.3f}{:>7.1f} %{:>15}{:>15}{:>9}{:>9}{:>9}", one.seconds, 100 * one.share,
                     format_count(one.calls), format_count(one.skipped), saved(one.seconds_saved),
                     format_count(one.retries), format_count(one.repairs));
}

std::string call_head(const char* what) {
  return fmt::format("\n  {:<20}{:>9}{:>9}{:>15}{:>15}{:>9}{:>9}{:>9}\n", what, "seconds", "share",
                     "parcel calls", "skipped", "saved <=", "retries", "repairs");
}

std::string operator_table(const Summary& s) {
  if (s.operators.empty() && s.watch.checks == 0) return {};
  std::string text = call_head("operator");
  for (const OperatorSummary& one : s.operators) {
    text += fmt::format("  {:<20}{}\n", one.name, call_columns(one.calls));
    if (one.calls.skipped > 0)
      text += fmt::format(
          "  {:<20}skipped because nothing had changed {}, by block {}, by parcel {}"
          "{}\n",
          "", format_count(one.calls.skipped_by_epoch), format_count(one.calls.skipped_by_bounds),
          format_count(one.calls.skipped_by_list),
          one.calls.audited > 0 ? "; audited " + format_count(one.calls.audited) : "");
  }
  if (s.watch.checks > 0)
    text += fmt::format("  {:<20}{:>9.3f}  {} looks at what was left out\n", "watch",
                        s.watch.seconds, format_count(s.watch.checks));
  return text;
}

std::string effect_table(const Summary& s) {
  if (s.effects.empty()) return {};
  std::string text = call_head("effect");
  for (const EffectSummary& effect : s.effects) {
    const std::string why = effect.verdict + ": " + effect.reason;
    if (effect.calls.calls == 0 && effect.calls.skipped == 0) {
      text += fmt::format("  {:<20} {}\n", effect.name, wrap_text(why, 23));
    } else {
      text += fmt::format("  {:<20}{}\n    {}\n", effect.name, call_columns(effect.calls),
                          wrap_text(why, 4));
    }
  }
  const LeftOutSummary& left = s.left_out;
  if (left.bytes_per_parcel > 0 || left.seconds > 0)
    text += "  " +
            wrap_text(fmt::format(
                          "done without: {:.0f} bytes per parcel ({}), {}", left.bytes_per_parcel,
                          bytes(left.bytes_per_parcel * s.parcels_mean),
                          std::isfinite(left.seconds)
                              ? fmt::format("{:.3g} s of one core at measured costs", left.seconds)
                              : "time not known: 'pileus plan SCENE --measure' measures it"),
                      2) +
            "\n";
  return text;
}

std::string conservation_table(const Summary& s) {
  std::string text;
  for (const DiagnosticSummary& one : s.diagnostics)
    if (one.relative_change)
      text += fmt::format(
          "  {:<28}{:>16}{:>16}{:>12}  {}\n", one.name, number(one.initial), number(one.final),
          std::isfinite(*one.relative_change) ? fmt::format("{:.2e}", *one.relative_change)
                                              : std::string("n/a"),
          one.units);
  if (!text.empty())
    text = fmt::format("\n  {:<28}{:>16}{:>16}{:>12}  {}\n", "conserved", "initial", "final",
                       "rel. change", "units") +
           text;
  std::string budgets;
  for (const BudgetSummary& one : s.budgets)
    budgets += fmt::format("  {:<28}{:>16}{:>16}{:>12}  {}\n", one.name, number(one.final),
                           number(one.sources), fmt::format("{:.2e}", one.defect), one.units);
  if (!budgets.empty())
    budgets = fmt::format("\n  {:<28}{:>16}{:>16}{:>12}  {}\n", "budget", "final", "sources",
                          "defect", "units") +
              budgets;
  return text + budgets;
}

std::string expect_table(const Summary& s) {
  if (s.expect.empty()) return {};
  std::string text = "\n  expected\n";
  for (const ExpectSummary& one : s.expect) {
    std::string what = one.diagnostic + " " + one.statistic;
    if (one.at) what += fmt::format(" at {} s", number(*one.at));
    std::string bound;
    if (one.low) bound += fmt::format(" >= {}", number(*one.low));
    if (one.low && one.high) bound += " and";
    if (one.high) bound += fmt::format(" <= {}", number(*one.high));
    text += fmt::format("  {}  {} = {}, bound{}\n", one.passed ? "pass" : "FAIL", what,
                        number(one.value), bound);
  }
  return text;
}

std::string where_results_are(const Summary& s) {
  std::string text = fmt::format("\n  results in {}\n", s.directory);
  for (const OutputSummary& one : s.outputs)
    text += fmt::format("    {:<22}{}{}\n", one.path, one.content,
                        one.records > 0 ? fmt::format(" ({} records)", one.records) : "");
  return text;
}

}  // namespace

std::string print_ledger(const Summary& summary) {
  return headline(summary) + phase_table(summary) + operator_table(summary) +
         effect_table(summary) + conservation_table(summary) + expect_table(summary) +
         where_results_are(summary);
}

}  // namespace pileus::output

#include "study/study_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/terminal.hpp"

namespace pileus::study {

namespace {

using Cells = std::vector<std::string>;

/// Columns a UTF-8 text takes: its code points.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

/// Rows with the first column to the left and the others to the right; an empty row is a gap.
std::string align(const std::vector<Cells>& rows) {
  std::vector<std::size_t> widths;
  for (const Cells& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  std::string text;
  for (const Cells& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string padding(widths[c] - width_of(row[c]), ' ');
      line += "  " + (c == 0 ? row[c] + padding : padding + row[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

std::string number(double value, const char* format = "{:.4g}") {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

/// "1.41e-02", with the spread over seeds in per cent where there is one.
std::string error_cell(const Spread& error) {
  if (!error.known()) return "-";
  std::string text = fmt::format("{:.3e}", error.value);
  if (error.high > error.low && error.value > 0)
    text += fmt::format(" ±{:.0f}%", 50 * (error.high - error.low) / error.value);
  return text;
}

class Writer {
 public:
  explicit Writer(const Findings& findings) : findings_(findings) {
    for (std::size_t n = 0; n < norms(); ++n) fronts_.push_back(findings_.front(n));
  }

  std::string table() {
    const CostWords cost = words_of(findings_.study);
    Cells head = {"point", "steps", "parcels",
                  fmt::format("{}{}", cost.name, cost.unit == "1" ? "" : ", " + cost.unit)};
    for (const ErrorNorm& norm : findings_.study.errors) {
      head.push_back(norm.name);
      head.emplace_back("order");
    }
    rows_ = {std::move(head)};
    const auto& curves = findings_.layout.curves;
    const bool product = findings_.study.combine == Study::Combine::product;
    for (std::size_t c = 0; c < curves.size(); ++c)
      if (!product || curves[c].knob == 0) add_curve(c);
    add_published();
    return align(rows_);
  }

 private:
  std::size_t norms() const { return findings_.study.errors.size(); }

  bool on_front(std::size_t norm, std::size_t point) const {
    const auto& front = fronts_[norm];
    return std::find(front.begin(), front.end(), point) != front.end();
  }

  void add_curve(std::size_t c) {
    const KnobCurve& curve = findings_.layout.curves[c];
    if (rows_.size() > 1) rows_.emplace_back();
    std::vector<Orders> orders;
    for (std::size_t n = 0; n < norms(); ++n) orders.push_back(findings_.orders(c, n));
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const PointResult& point = findings_.points[curve.points[i]];
      Cells row = {point.label, number(point.steps, "{:.0f}"),
                   std::isnan(point.parcels)
                       ? "-"
                       : format_count(static_cast<std::uint64_t>(std::llround(point.parcels))),
                   number(point.cost.value)};
      for (std::size_t n = 0; n < norms(); ++n) {
        row.push_back((on_front(n, curve.points[i]) ? "* " : "") + error_cell(point.errors[n]));
        const bool resolved =
            i == 0 || findings_.is_resolved(curve.points[i - 1], curve.points[i], n);
        row.push_back(resolved ? number(orders[n].local[i], "{:.2f}") : "n.r.");
      }
      rows_.push_back(std::move(row));
    }
  }

  void add_published() {
    if (findings_.study.published.empty()) return;
    rows_.emplace_back();
    for (const PublishedPoint& point : findings_.study.published) {
      std::string label = point.label;
      for (const auto& [knob, value] : point.numbers)
        label += fmt::format(", {} {:g}", knob, value);
      Cells row = {label, "-", "-", number(point.cost)};
      for (const ErrorNorm& norm : findings_.study.errors) {
        const auto error = point.errors.find(norm.name);
        row.push_back(error == point.errors.end() ? "-" : fmt::format("{:.3e}", error->second));
        row.emplace_back("");
      }
      rows_.push_back(std::move(row));
    }
  }

  const Findings& findings_;
  std::vector<std::vector<std::size_t>> fronts_;
  std::vector<Cells> rows_;
};

/// Orders of whole curves, where a knob has numbers.
std::string orders_text(const Findings& findings) {
  std::vector<Cells> rows;
  for (std::size_t c = 0; c < findings.layout.curves.size(); ++c) {
    const KnobCurve& curve = findings.layout.curves[c];
    const std::string& knob = findings.layout.knobs[curve.knob].name;
    Cells row = {curve.label.empty() || curve.label == knob
                     ? fmt::format("along {}", knob)
                     : fmt::format("along {} ({})", knob, curve.label)};
    bool any = false;
    for (std::size_t n = 0; n < findings.study.errors.size(); ++n) {
      const double order = findings.orders(c, n).overall;
      any |= !std::isnan(order);
      row.push_back(number(order, "{:.2f}"));
    }
    if (any) rows.push_back(std::move(row));
  }
  if (rows.empty()) return {};
  Cells head = {"order of the error"};
  for (const ErrorNorm& norm : findings.study.errors) head.push_back(norm.name);
  rows.insert(rows.begin(), std::move(head));
  return "\n" + align(rows);
}

std::string failures_text(const Findings& findings) {
  std::string text;
  for (const PointResult& point : findings.points)
    if (!point.failure.empty())
      text += fmt::format("  failed: {}: {}\n", point.label,
                          point.failure.substr(0, point.failure.find('\n')));
  return text.empty() ? text : "\n" + text;
}

/// One line of a verdict; `point` says of what and `value` what was found.
std::string verdict_line(const Verdict& verdict, const std::string& point,
                         const std::string& value) {
  const StudyExpectation& e = verdict.expectation;
  std::string bound;
  if (e.low) bound += fmt::format(" >= {:.4g}", *e.low);
  if (e.high) bound += fmt::format(" <= {:.4g}", *e.high);
  const std::string what = e.of == StudyExpectation::Of::order
                               ? fmt::format("order of {} along {}", e.norm, e.along)
                               : e.norm;
  return fmt::format("  {}  {} ({}) = {}{}  ({})\n", verdict.passed ? "pass" : "MISS", what, point,
                     value, bound, e.source);
}

/// A line for every miss, and one for all that keep the same bound.
std::string verdicts_text(const std::vector<Verdict>& verdicts) {
  std::string text;
  for (std::size_t first = 0, end = 0; first < verdicts.size(); first = end) {
    std::vector<const Verdict*> kept;
    const auto is_of_same_bound = [&](const Verdict& verdict) {
      const scene::Location &a = verdict.expectation.where, &b = verdicts[first].expectation.where;
      return a.line == b.line && a.column == b.column;
    };
    for (end = first; end < verdicts.size() && is_of_same_bound(verdicts[end]); ++end) {
      const Verdict& verdict = verdicts[end];
      if (verdict.passed)
        kept.push_back(&verdict);
      else
        text += verdict_line(verdict, verdict.point, fmt::format("{:.4g}", verdict.value));
    }
    if (kept.empty()) continue;
    const auto [low, high] = std::minmax_element(
        kept.begin(), kept.end(), [](auto* a, auto* b) { return a->value < b->value; });
    const bool one = kept.size() == 1;
    text += verdict_line(*kept.front(),
                         one ? kept.front()->point : fmt::format("{} points", kept.size()),
                         one ? fmt::format("{:.4g}", (*low)->value)
                             : fmt::format("{:.4g} to {:.4g}", (*low)->value, (*high)->value));
  }
  return text.empty() ? text : "\n" + text;
}

}  // namespace

std::string findings_table(const Findings& findings, const std::vector<Verdict>& verdicts) {
  std::string text = findings.study.title + "\n\n";
  text += Writer(findings).table();
  text += orders_text(findings);
  text += "\n  * on the Pareto front: nothing is both cheaper and more accurate";
  if (!findings.study.seeds.empty())
    text += "\n  ± half the range over the seeds; n.r.: the change is smaller than that";
  text += '\n';
  text += failures_text(findings);
  text += verdicts_text(verdicts);
  return text;
}

}  // namespace pileus::study

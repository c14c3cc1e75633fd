#include "study/work_precision_picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace pileus::study {

namespace {

constexpr std::array<const char*, 8> colours = {"#1b4f9c", "#1b9e77", "#6fa8dc", "#8d5a97",
                                                "#8fd3a5", "#c99a2e", "#7570b3", "#555555"};
constexpr std::array<const char*, 4> published_colours = {"#a6420a", "#d95f02", "#e78ac3",
                                                          "#666666"};
constexpr int panel_width = 520, panel_height = 520;

/// Text between single quotes of a gnuplot script; enhanced text is off where it is used.
std::string quote(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    result += c;
    if (c == '\'') result += c;
  }
  return result + "'";
}

/// Smallest and largest of positive numbers, with room beside them on a logarithmic axis.
struct LogRange {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  void add(double value) {
    if (!(value > 0) || std::isinf(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool known() const { return high > 0; }
  std::string set(const char* axis) const {
    if (!known()) return fmt::format("set {}range [*:*]\n", axis);
    const double room = std::max(std::pow(high / low, 0.08), 1.3);
    const bool decades = high / low > 30;
    return fmt::format("set {0}range [{1:.4g}:{2:.4g}]\nset format {0} '{3}'\nset {0}tics {4}\n",
                       axis, low / room, high * room, decades ? "10^{%T}" : "%g",
                       decades ? "autofreq" : within_a_decade(low / room, high * room));
  }

 private:
  /// Round numbers between the ends of an axis on which hardly a power of ten may lie: 1, 2 and 5,
  /// or, where fewer than three of those do, multiples of one round step.
  static std::string within_a_decade(double from, double to) {
    std::vector<double> at;
    for (double decade = std::pow(10.0, std::floor(std::log10(from))); decade <= to; decade *= 10)
      for (const double digit : {1.0, 2.0, 5.0})
        if (digit * decade >= from && digit * decade <= to) at.push_back(digit * decade);
    if (at.size() < 3) {
      at.clear();
      const double wanted = (to - from) / 4,
                   decade = std::pow(10.0, std::floor(std::log10(wanted)));
      const double step = decade * (wanted >= 5 * decade ? 5 : wanted >= 2 * decade ? 2 : 1);
      for (double n = std::ceil(from / step); n * step <= to; ++n) at.push_back(n * step);
    }
    return fmt::format("({:.6g})", fmt::join(at, ", "));
  }
};

class Script {
 public:
  Script(const Findings& findings, std::size_t norm)
      : findings_(findings), norm_(norm), front_(findings.front(norm)) {}

  std::string text() {
    write_data();
    const int panels = 1 + static_cast<int>(knobs().size());
    script_ += fmt::format(
        "set encoding utf8\nset tics out nomirror\nset border 3 lc rgb '#444444'\n"
        "set grid lc rgb '#dddddd'\nset logscale xy\nset bmargin 8\nset key below center "
        "horizontal noenhanced samplen 2 font ',10'\nset multiplot layout 1,{} title {} noenhanced "
        "font ',14'\n",
        panels, quote(findings_.study.title));
    script_ += errors_.set("y");
    script_ +=
        fmt::format("set ylabel {} noenhanced\n", quote(findings_.study.errors[norm_].title));
    cost_panel();
    for (const std::size_t knob : knobs()) knob_panel(knob);
    return script_ + "unset multiplot\n";
  }

  /// Knobs of which two values or more have a place on a logarithmic axis; a value of zero has none
  /// and is seen in the panel against cost only.
  std::vector<std::size_t> knobs() const {
    std::vector<std::size_t> numbered;
    for (std::size_t k = 0; k < findings_.layout.knobs.size(); ++k) {
      const auto& ladder = findings_.layout.knobs[k].ladder;
      if (std::count_if(ladder.begin(), ladder.end(), has_place) > 1) numbered.push_back(k);
    }
    if (numbered.size() > 3) numbered.resize(3);
    return numbered;
  }

 private:
  static bool has_place(const Rung& rung) { return rung.number > 0; }

  /// Curves drawn against cost: along the first knob, or every knob's own.
  bool in_cost_panel(const KnobCurve& curve) const {
    return findings_.study.combine != Study::Combine::product || curve.knob == 0;
  }

  void write_data() {
    const auto& curves = findings_.layout.curves;
    for (std::size_t c = 0; c < curves.size(); ++c) {
      script_ += fmt::format("$curve{} << EOD\n", c);
      for (const std::size_t p : curves[c].points) {
        const PointResult& point = findings_.points[p];
        const Spread& error = point.errors[norm_];
        if (!(error.value > 0) || !point.cost.known()) continue;
        const double at = findings_.number(p, curves[c].knob);
        script_ += fmt::format("{} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g} {:.6g}\n",
                               std::isnan(at) ? "NaN" : fmt::format("{:.6g}", at), point.cost.value,
                               point.cost.low, point.cost.high, error.value, error.low, error.high);
        costs_.add(point.cost.value);
        errors_.add(error.low);
        errors_.add(error.high);
      }
      script_ += "EOD\n";
    }
    script_ += "$front << EOD\n";
    for (const std::size_t p : front_) {
      const PointResult& point = findings_.points[p];
      if (point.errors[norm_].value > 0)
        script_ += fmt::format("{:.6g} {:.6g}\n", point.cost.value, point.errors[norm_].value);
    }
    script_ += "EOD\n";
    write_published();
  }

  void write_published() {
    for (const PublishedPoint& point : findings_.study.published) {
      if (std::find(labels_.begin(), labels_.end(), point.label) == labels_.end())
        labels_.push_back(point.label);
    }
    for (std::size_t l = 0; l < labels_.size(); ++l) {
      script_ += fmt::format("$published{} << EOD\n", l);
      for (const PublishedPoint& point : findings_.study.published) {
        if (point.label != labels_[l]) continue;
        const auto error = point.errors.find(findings_.study.errors[norm_].name);
        if (error == point.errors.end()) continue;
        script_ += fmt::format("{} {:.6g}",
                               std::isnan(point.cost) ? "NaN" : fmt::format("{:.6g}", point.cost),
                               error->second);
        for (const Knob& knob : findings_.layout.knobs) {
          const auto number = point.numbers.find(knob.name);
          script_ += number == point.numbers.end() ? std::string(" NaN")
                                                   : fmt::format(" {:.6g}", number->second);
        }
        script_ += '\n';
        costs_.add(point.cost);
        errors_.add(error->second);
      }
      script_ += "EOD\n";
    }
  }

  /// Whether any published result has this norm, and a cost or a place on the knob.
  bool has_published(std::size_t label, std::optional<std::size_t> knob) const {
    const std::string& norm = findings_.study.errors[norm_].name;
    return std::any_of(findings_.study.published.begin(), findings_.study.published.end(),
                       [&](const PublishedPoint& point) {
                         return point.label == labels_[label] && point.errors.count(norm) > 0 &&
                                (knob ? point.numbers.count(findings_.layout.knobs[*knob].name) > 0
                                      : !std::isnan(point.cost));
                       });
  }

  std::string title_of(std::size_t c) const {
    const KnobCurve& curve = findings_.layout.curves[c];
    return curve.label.empty() ? "notitle" : "title " + quote(curve.label);
  }

  void plot(std::vector<std::string> parts) {
    if (parts.empty()) parts.emplace_back("NaN notitle");
    script_ += "plot ";
    for (std::size_t i = 0; i < parts.size(); ++i) script_ += (i > 0 ? ", \\\n  " : "") + parts[i];
    script_ += '\n';
  }

  void cost_panel() {
    const CostWords cost = words_of(findings_.study);
    script_ += costs_.set("x");
    script_ +=
        fmt::format("set title 'error against {0}' noenhanced\nset xlabel '{0}{1}' noenhanced\n",
                    cost.name, cost.unit == "1" ? "" : ", " + cost.unit);
    std::vector<std::string> parts = {
        "$front using 1:2 with lines lw 5 lc rgb '#f0c94d' title 'Pareto front'"};
    const auto& curves = findings_.layout.curves;
    for (std::size_t c = 0, n = 0; c < curves.size(); ++c) {
      if (!in_cost_panel(curves[c])) continue;
      const char* colour = colours[n++ % colours.size()];
      parts.push_back(
          fmt::format("$curve{} using 2:5 with linespoints pt 7 ps 0.8 lw 2 lc rgb "
                      "'{}' {}",
                      c, colour, title_of(c)));
      if (has_bars())
        parts.push_back(
            fmt::format("$curve{} using 2:5:3:4:6:7 with xyerrorbars ps 0 lw 1.5 lc "
                        "rgb '{}' notitle",
                        c, colour));
    }
    for (std::size_t l = 0; l < labels_.size(); ++l)
      if (has_published(l, {}))
        parts.push_back(
            fmt::format("$published{} using 1:2 with points pt {} ps 1.4 lc rgb '{}' "
                        "title {}",
                        l, marker(l), published_colour(l), quote(labels_[l])));
    plot(std::move(parts));
  }

  void knob_panel(std::size_t k) {
    const Knob& knob = findings_.layout.knobs[k];
    LogRange range;
    std::string tics;
    for (const Rung& rung : knob.ladder) {
      if (!has_place(rung)) continue;
      range.add(rung.number);
      tics += fmt::format("{}{:.6g}", tics.empty() ? "" : ", ", rung.number);
    }
    for (const PublishedPoint& point : findings_.study.published)
      if (const auto number = point.numbers.find(knob.name); number != point.numbers.end())
        range.add(number->second);
    const std::string axis = knob.axis.empty() ? knob.name : knob.axis;
    script_ += range.set("x");
    script_ += fmt::format(
        "set title {} noenhanced\nset xlabel {} noenhanced\nset format x '%g'\nset xtics ({})\n",
        quote("error against " + knob.name), quote(axis), tics);
    std::vector<std::string> parts = guides(k);
    const auto& curves = findings_.layout.curves;
    for (std::size_t c = 0, n = 0; c < curves.size(); ++c) {
      if (curves[c].knob != k) continue;
      const char* colour = colours[n++ % colours.size()];
      parts.push_back(
          fmt::format("$curve{} using 1:5 with linespoints pt 7 ps 0.8 lw 2 lc rgb "
                      "'{}' {}",
                      c, colour, title_of(c)));
      if (findings_.study.seeds.size() > 1)
        parts.push_back(fmt::format(
            "$curve{} using 1:5:6:7 with yerrorbars ps 0 lw 1.5 lc rgb '{}' notitle", c, colour));
    }
    for (std::size_t l = 0; l < labels_.size(); ++l)
      if (has_published(l, k))
        parts.push_back(
            fmt::format("$published{} using {}:2 with points pt {} ps 1.4 lc rgb '{}' "
                        "title {}",
                        l, k + 3, marker(l), published_colour(l), quote(labels_[l])));
    plot(std::move(parts));
    script_ += "set xtics autofreq\n";
  }

  /// Errors rise with a time step and fall with a number of cells: ladders go from coarse to fine.
  static bool rises_with_number(const Knob& knob) {
    return knob.ladder.front().number > knob.ladder.back().number;
  }

  /// The curve along a knob whose error falls fastest.
  std::vector<KnobCurve>::const_iterator steepest(std::size_t k) const {
    const auto& curves = findings_.layout.curves;
    auto best = curves.end();
    double most = -std::numeric_limits<double>::infinity();
    for (auto curve = curves.begin(); curve != curves.end(); ++curve) {
      const double order =
          findings_.orders(static_cast<std::size_t>(curve - curves.begin()), norm_).overall;
      if (curve->knob != k || !(order > most)) continue;
      best = curve;
      most = order;
    }
    return best;
  }

  /// Straight lines of the norm's guide slopes, a little beside the middle of that curve.
  std::vector<std::string> guides(std::size_t k) const {
    std::vector<std::string> parts;
    const auto curve = steepest(k);
    if (curve == findings_.layout.curves.end()) return parts;
    const std::size_t middle = curve->points[curve->points.size() / 2];
    const double error = findings_.points[middle].errors[norm_].value,
                 at = findings_.number(middle, k);
    if (!(error > 0 && at > 0)) return parts;
    const int sign = rises_with_number(findings_.layout.knobs[k]) ? 1 : -1;
    int dash = 2;
    for (const double slope : findings_.study.errors[norm_].slopes)
      parts.push_back(
          fmt::format("{:.6g}*(x/{:.6g})**({:g}) with lines dt {} lw 1.5 lc rgb "
                      "'#999999' title 'slope {:g}'",
                      0.6 * error, at, sign * slope, dash++, sign * slope));
    return parts;
  }

  bool has_bars() const { return findings_.study.seeds.size() > 1 || findings_.study.repeats > 1; }
  static int marker(std::size_t label) { return label % 2 == 0 ? 9 : 11; }
  static const char* published_colour(std::size_t label) {
    return published_colours[label % published_colours.size()];
  }

  const Findings& findings_;
  std::size_t norm_;
  std::vector<std::size_t> front_;
  std::vector<std::string> labels_;  // of published curves
  LogRange costs_, errors_;
  std::string script_;
};

}  // namespace

std::string work_precision_script(const Findings& findings, std::size_t norm) {
  return Script(findings, norm).text();
}

PictureSize work_precision_size(const Findings& findings) {
  const int panels = 1 + static_cast<int>(Script(findings, 0).knobs().size());
  return {panels * panel_width, panel_height};
}

}  // namespace pileus::study

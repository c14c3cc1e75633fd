#include "study/report_page.hpp"

#include <fmt/format.h>

#include "base/terminal.hpp"

namespace pileus::study {

using nlohmann::json;

namespace {

constexpr const char* style = R"(
  body { font: 15px/1.5 system-ui, sans-serif; color: #1c2430; max-width: 1100px;
         margin: 2rem auto; padding: 0 1rem; background: #fff; }
  h1 { font-size: 1.6rem; margin-bottom: 0.2rem; }
  h2 { font-size: 1.15rem; margin-top: 2.2rem; border-bottom: 1px solid #d5dce6; }
  table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
  th, td { padding: 0.15rem 0.9rem 0.15rem 0; text-align: right; white-space: nowrap; }
  th { font-weight: 600; border-bottom: 1px solid #d5dce6; }
  th:first-child, td:first-child, td.text { text-align: left; white-space: normal; }
  .missed { color: #a3211b; font-weight: 600; }
  .quiet { color: #5b6675; }
  figure { margin: 1rem 0; overflow-x: auto; }
  svg { max-width: 100%; height: auto; }
)";

std::string number(const json& value) {
  if (!value.is_number()) return "–";
  return fmt::format("{:.6g}", value.get<double>());
}

std::string cell(const std::string& text) {
  return "<td>" + escape_html(text) + "</td>";
}
std::string text_cell(const std::string& text) {
  return "<td class=\"text\">" + escape_html(text) + "</td>";
}

/// A table, or nothing without rows.
std::string table(const std::string& heading, const std::vector<std::string>& columns,
                  const std::string& rows) {
  if (rows.empty()) return {};
  std::string html = "<h2>" + escape_html(heading) + "</h2>\n<table>\n<tr>";
  for (const std::string& column : columns) html += "<th>" + escape_html(column) + "</th>";
  return html + "</tr>\n" + rows + "</table>\n";
}

std::string expectation_rows(const json& summary) {
  std::string rows;
  for (const json& each : summary.value("expect", json::array())) {
    const json& bound = each.at("bound");
    const bool passed = each.at("passed").get<bool>();
    std::string what = each.at("diagnostic").get<std::string>() + " ";
    what += each.at("at_s").is_number() ? "at " + number(each.at("at_s")) + " s"
                                        : each.at("statistic").get<std::string>();
    rows += "<tr>" + cell(what) + cell(number(each.at("value"))) + cell(number(bound.at("low"))) +
            cell(number(bound.at("high"))) +
            (passed ? "<td>met</td>" : "<td class=\"missed\">missed</td>") +
            text_cell(each.value("source", "")) + "</tr>\n";
  }
  return rows;
}

std::string diagnostic_rows(const json& summary) {
  std::string rows;
  const json diagnostics = summary.value("diagnostics", json::object());
  for (const auto& [name, each] : diagnostics.items()) {
    rows += "<tr>" + cell(name) + cell(number(each.at("initial"))) +
            cell(number(each.at("final"))) + cell(number(each.at("min"))) +
            cell(number(each.at("max"))) +
            cell(each.contains("relative_change") ? number(each.at("relative_change")) : "") +
            text_cell(each.value("units", "")) + "</tr>\n";
  }
  return rows;
}

std::string phase_rows(const json& summary) {
  std::string rows;
  const json phases = summary.value("phases", json::object());
  for (const auto& [name, each] : phases.items()) {
    const json& share = each.at("share");
    rows += "<tr>" + cell(name) + cell(fmt::format("{:.3f}", each.at("seconds").get<double>())) +
            cell(share.is_number() ? fmt::format("{:.1f} %", 100 * share.get<double>()) : "–") +
            "</tr>\n";
  }
  return rows;
}

std::string headline(const json& summary) {
  const json& parcels = summary.at("parcels");
  std::string line =
      fmt::format("{}: {} steps to {} s with {} threads in {}, {} parcels at the end",
                  summary.at("status").get<std::string>(), summary.at("steps").get<std::uint64_t>(),
                  number(summary.at("simulated_time_s")), summary.at("threads").get<int>(),
                  format_duration(summary.at("wall_s").get<double>()),
                  format_count(parcels.at("final").get<std::uint64_t>()));
  if (const json& cost = summary.at("ns_per_parcel_step"); cost.is_number()) {
    line += fmt::format(", {:.0f} ns of one core per parcel and step", cost.get<double>());
  }
  return "<p class=\"quiet\">" + escape_html(line) + "</p>\n";
}

/// From the root element on: the XML declaration has no place inside HTML.
std::string inline_svg(const std::string& svg) {
  const std::size_t root = svg.find("<svg");
  return root == std::string::npos ? std::string() : svg.substr(root);
}

}  // namespace

std::string escape_html(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string report_page(const json& summary, const std::vector<PageSection>& sections) {
  std::string title = "Run report";
  if (summary.is_object()) {
    title = summary.value("title", "");
    if (title.empty()) title = summary.value("scene", "Run report");
  }
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += fmt::format("<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
                      escape_html(title), style);
  html += summary.is_object() ? headline(summary)
                              : "<p class=\"quiet\">The run has no summary yet.</p>\n";
  if (summary.is_object()) {
    html += table("Expectations", {"diagnostic", "value", "at least", "at most", "", "source"},
                  expectation_rows(summary));
  }
  for (const PageSection& section : sections) {
    if (section.svgs.empty()) continue;
    html += "<h2>" + escape_html(section.heading) + "</h2>\n";
    for (const std::string& svg : section.svgs) {
      html += "<figure>\n" + inline_svg(svg) + "</figure>\n";
    }
  }
  if (summary.is_object()) {
    html +=
        table("Diagnostics", {"name", "initial", "final", "min", "max", "relative change", "units"},
              diagnostic_rows(summary));
    html += table("Time by phase", {"phase", "seconds", "share"}, phase_rows(summary));
    html += fmt::format(
        "<p class=\"quiet\">Pileus {}, commit {}, {}. Final state SHA-256 {}.</p>\n",
        escape_html(summary.value("version", "")), escape_html(summary.value("commit", "")),
        escape_html(summary.value("compiler", "")), escape_html(summary.value("state_sha256", "")));
  }
  return html + "</body>\n</html>\n";
}

}  // namespace pileus::study

#include "study/study_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

#include "base/error.hpp"
#include "base/sha256.hpp"
#include "base/units.hpp"
#include "base/version.hpp"
#include "output/posix_file.hpp"
#include "output/table_file.hpp"
#include "scene/tree.hpp"
#include "study/outcome.hpp"
#include "study/scene_settings.hpp"

namespace pileus::study {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// A row of the table: a point of the study, or a published one.
struct Row {
  std::string label, source;  // empty source: this study
  const PointResult* point = nullptr;
  const PublishedPoint* published = nullptr;
};

std::vector<Row> rows_of(const Findings& findings) {
  std::vector<Row> rows;
  for (const PointResult& point : findings.points) rows.push_back({point.label, "", &point, {}});
  for (const PublishedPoint& point : findings.study.published)
    rows.push_back({point.label, point.source, nullptr, &point});
  return rows;
}

double knob_number(const Findings& findings, const Row& row, std::size_t knob) {
  if (row.point == nullptr) {
    const auto number = row.published->numbers.find(findings.layout.knobs[knob].name);
    return number == row.published->numbers.end() ? not_a_number : number->second;
  }
  const int rung = row.point->rungs[knob];
  return rung < 0 ? not_a_number
                  : findings.layout.knobs[knob].ladder[static_cast<std::size_t>(rung)].number;
}

Spread error_of(const Findings& findings, const Row& row, std::size_t norm) {
  if (row.point != nullptr) return row.point->errors[norm];
  const auto error = row.published->errors.find(findings.study.errors[norm].name);
  if (error == row.published->errors.end()) return {};
  return {error->second, error->second, error->second};
}

std::vector<output::NumberColumn> number_columns(const Findings& findings) {
  std::vector<output::NumberColumn> columns;
  const std::vector<Row> rows = rows_of(findings);
  const auto add = [&](std::string name, std::string unit, std::string meaning, auto&& value) {
    output::NumberColumn column{{std::move(name), std::move(unit), std::move(meaning), ""}, {}};
    for (const Row& row : rows) column.values.push_back(value(row));
    columns.push_back(std::move(column));
  };
  for (std::size_t k = 0; k < findings.layout.knobs.size(); ++k)
    add(identifier(findings.layout.knobs[k].name), "1", "value of the knob",
        [&](const Row& row) { return knob_number(findings, row, k); });
  const CostWords cost = words_of(findings.study);
  add("cost", cost.unit, cost.name + ", median of the runs", [](const Row& row) {
    return row.point != nullptr ? row.point->cost.value : row.published->cost;
  });
  const auto of_point = [](auto member) {
    return [member](const Row& row) { return row.point ? member(*row.point) : not_a_number; };
  };
  add("cost_low", cost.unit, "least cost of the runs",
      of_point([](const PointResult& p) { return p.cost.low; }));
  add("cost_high", cost.unit, "largest cost of the runs",
      of_point([](const PointResult& p) { return p.cost.high; }));
  add("core_time", cost.unit == "1" ? "s" : cost.unit, "processor time of the time steps",
      of_point([](const PointResult& p) { return p.core_time.value; }));
  add("wall_time", cost.unit == "1" ? "s" : cost.unit, "wall time of the time steps",
      of_point([](const PointResult& p) { return p.wall_time.value; }));
  add("steps", "1", "time steps", of_point([](const PointResult& p) { return p.steps; }));
  add("parcels", "1", "mean number of parcels",
      of_point([](const PointResult& p) { return p.parcels; }));
  for (std::size_t n = 0; n < findings.study.errors.size(); ++n) {
    const ErrorNorm& norm = findings.study.errors[n];
    const std::string name = "error_" + identifier(norm.name);
    add(name, "1", norm.title, [&](const Row& row) { return error_of(findings, row, n).value; });
    add(name + "_low", "1", "lowest over the seeds",
        [&](const Row& row) { return error_of(findings, row, n).low; });
    add(name + "_high", "1", "highest over the seeds",
        [&](const Row& row) { return error_of(findings, row, n).high; });
  }
  return columns;
}

scene::Node tree_of(const std::string& path) {
  scene::Problems problems;
  scene::Node root = scene::load_document(path, problems);
  problems.throw_if_any();
  return root;
}

void remove_keys(scene::Node& node, std::initializer_list<std::string_view> keys) {
  std::erase_if(node.entries, [&](const scene::Entry& entry) {
    return std::find(keys.begin(), keys.end(), entry.key) != keys.end();
  });
}

std::string quote(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

Json spread_json(const Spread& spread) {
  return {{"value", spread.value}, {"low", spread.low}, {"high", spread.high}};
}

Json point_json(const Findings& findings, const PointResult& point) {
  Json json;
  const std::vector<std::string> settings = assignments(point.settings);
  json["label"] = point.label;
  json["settings"] = settings;
  if (findings.study.experiment == Study::Experiment::scene)
    json["scene_sha256"] = scene_fingerprint(findings.study.scene_path(), settings);
  json["cost"] = spread_json(point.cost);
  json["core_time"] = point.core_time.value;
  json["wall_time"] = point.wall_time.value;
  json["steps"] = point.steps;
  json["parcels"] = point.parcels;
  json["errors"] = Json::object();
  for (std::size_t n = 0; n < findings.study.errors.size(); ++n)
    json["errors"][findings.study.errors[n].name] = spread_json(point.errors[n]);
  if (!point.failure.empty()) json["failure"] = point.failure;
  json["commit"] = point.commit;
  json["date"] = point.date;
  return json;
}

}  // namespace

std::string scene_fingerprint(const std::string& path, const std::vector<std::string>& settings) {
  scene::Node root = tree_of(path);
  scene::Problems problems;
  for (const std::string& setting : settings) scene::apply_override(root, setting, problems);
  problems.throw_if_any();
  remove_keys(root, {"expect", "output"});
  const auto remove_inside = [&](std::string_view section,
                                 std::initializer_list<std::string_view> names) {
    scene::Entry* entry = root.find(section);
    if (entry == nullptr) return;
    remove_keys(entry->value, names);
    if (entry->value.entries.empty()) remove_keys(root, {section});
  };
  remove_inside("scene", {"name", "title", "description"});
  return sha256_hex(scene::flow_text(root));
}

std::string machine_name() {
  std::ifstream file("/proc/cpuinfo");
  std::string name = "unknown processor";
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    name = line.substr(std::min(line.find(':') + 2, line.size()));
    break;
  }
  return fmt::format("{}, {} cores", name, std::thread::hardware_concurrency());
}

void write_findings_netcdf(const fs::path& path, const Findings& findings) {
  const std::vector<Row> rows = rows_of(findings);
  output::WordColumn labels{{"label", "", "what was run", ""}, {}},
      sources{{"source", "", "where a result of others was published", ""}, {}},
      failures{{"failure", "", "why a run did not reach its end", ""}, {}};
  for (const Row& row : rows) {
    labels.values.push_back(row.label);
    sources.values.push_back(row.source);
    failures.values.push_back(row.point != nullptr ? row.point->failure : "");
  }
  output::Provenance provenance;
  provenance.title = findings.study.title;
  provenance.source = fmt::format("Pileus {} ({})", build_record().version, build_record().commit);
  provenance.history = fmt::format("{} pileus study {}", date_now(), findings.study.path);
  provenance.scene = findings.study.experiment == Study::Experiment::scene
                         ? scene::flow_text(tree_of(findings.study.scene_path()))
                         : "shape_integrators";
  provenance.attributes["machine"] = machine_name();
  output::write_table(path, "point", rows.size(), number_columns(findings),
                      {labels, sources, failures}, provenance);
}

void write_findings_csv(const fs::path& path, const Findings& findings) {
  const std::vector<output::NumberColumn> columns = number_columns(findings);
  const std::vector<Row> rows = rows_of(findings);
  std::string text = "label";
  for (const output::NumberColumn& column : columns) text += "," + column.variable.name;
  text += ",source\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += quote(rows[r].label);
    for (const output::NumberColumn& column : columns)
      text += "," + (std::isnan(column.values[r]) ? std::string() : shortest(column.values[r]));
    text += "," + quote(rows[r].source) + "\n";
  }
  output::replace_file(path, text);
}

void write_findings_json(const fs::path& path, const Findings& findings) {
  const Study& study = findings.study;
  const CostWords cost = words_of(study);
  Json json;
  json["study"] = study.name;
  json["title"] = study.title;
  if (study.experiment == Study::Experiment::scene)
    json["scene"] = fs::relative(study.scene_path(), fs::absolute(path).parent_path()).string();
  json["settings"] = assignments(study.settings);
  json["date"] = date_now();
  json["version"] = build_record().version;
  json["machine"] = machine_name();
  json["threads"] = study.threads;
  json["cost"] = {{"name", cost.name}, {"unit", cost.unit}};
  json["norms"] = Json::object();
  for (const ErrorNorm& norm : study.errors) json["norms"][norm.name] = norm.title;
  json["points"] = Json::array();
  for (const PointResult& point : findings.points)
    if (!point.only_reference) json["points"].push_back(point_json(findings, point));
  output::replace_file(path, json.dump(2) + "\n");
}

}  // namespace pileus::study

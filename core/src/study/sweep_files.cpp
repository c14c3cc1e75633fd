#include "study/sweep_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "base/units.hpp"
#include "base/version.hpp"
#include "output/posix_file.hpp"
#include "study/outcome.hpp"

namespace pileus::study {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr std::array<const char*, 4> statistics = {"final", "mean", "min", "max"};

/// One line without tabs.
std::string cell(std::string text) {
  for (char& c : text)
    if (c == '\t' || c == '\n') c = ' ';
  return text;
}

std::string quote(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

Json member_json(const SweepResult& result, std::size_t m) {
  const Member& member = result.ensemble.members[m];
  const MemberRecord& record = result.records[m];
  Json json;
  json["index"] = m;
  json["folder"] = fs::relative(member_folder(result.directory, m), result.directory).string();
  json["parameters"] = Json::object();
  for (std::size_t p = 0; p < member.values.size(); ++p)
    if (!member.values[p].text.empty())
      json["parameters"][result.ensemble.parameters[p].name] = member.values[p].text;
  if (member.seed) json["seed"] = *member.seed;
  json["settings"] = member.overrides;
  json["status"] = word_of(record.status);
  if (record.status == MemberRecord::Status::failed) {
    json["exit_code"] = record.code;
    json["words"] = record.words;
  }
  json["sha256"] = member.key;
  json["wall_s"] = record.wall;
  return json;
}

/// The diagnostics of a finished member by name and statistic; empty when it left none.
std::map<std::string, std::array<std::string, 4>> diagnostics_of(const fs::path& folder,
                                                                 std::vector<std::string>& names) {
  std::map<std::string, std::array<std::string, 4>> found;
  std::ifstream file(folder / "summary.json");
  const Json summary = Json::parse(file, nullptr, false);
  if (!summary.is_object() || !summary.contains("diagnostics")) return found;
  for (const auto& [name, diagnostic] : summary.at("diagnostics").items()) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    for (std::size_t s = 0; s < statistics.size(); ++s) {
      const auto value = diagnostic.find(statistics[s]);
      if (value != diagnostic.end() && value->is_number())
        found[name][s] = shortest(value->get<double>());
    }
  }
  return found;
}

}  // namespace

void write_member_lists(const SweepResult& result) {
  const Ensemble& ensemble = result.ensemble;
  Json json;
  json["sweep"] = ensemble.sweep.name;
  json["title"] = ensemble.sweep.title;
  json["scene"] =
      fs::relative(ensemble.sweep.scene_path(), fs::absolute(result.directory)).string();
  json["version"] = build_record().version;
  json["date"] = date_now();
  json["parameters"] = Json::object();
  for (const Parameter& parameter : ensemble.parameters)
    json["parameters"][parameter.name] = parameter.keys;
  json["members"] = Json::array();
  std::string table = "index";
  for (const Parameter& parameter : ensemble.parameters) table += "\t" + cell(parameter.name);
  table += "\tseed\tstatus\tsha256\twall_s\n";
  for (std::size_t m = 0; m < ensemble.members.size(); ++m) {
    json["members"].push_back(member_json(result, m));
    const Member& member = ensemble.members[m];
    table += index_text(m);
    for (const ParameterValue& value : member.values) table += "\t" + cell(value.text);
    table += fmt::format("\t{}\t{}\t{}\t{:.3f}\n", member.seed ? std::to_string(*member.seed) : "",
                         word_of(result.records[m].status), member.key, result.records[m].wall);
  }
  fs::create_directories(result.directory);
  output::replace_file(result.directory / "sweep.json",
                       json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  output::replace_file(result.directory / "members.tsv", table);
}

void write_member_table(const SweepResult& result) {
  const Ensemble& ensemble = result.ensemble;
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::array<std::string, 4>>> diagnostics;
  for (std::size_t m = 0; m < ensemble.members.size(); ++m)
    diagnostics.push_back(result.records[m].status == MemberRecord::Status::done
                              ? diagnostics_of(member_folder(result.directory, m), names)
                              : std::map<std::string, std::array<std::string, 4>>());
  std::string text = "member";
  for (const Parameter& parameter : ensemble.parameters) text += "," + quote(parameter.name);
  text += ",seed,status,wall_s";
  for (const std::string& name : names)
    for (const char* statistic : statistics) text += fmt::format(",{}_{}", name, statistic);
  text += '\n';
  for (std::size_t m = 0; m < ensemble.members.size(); ++m) {
    const Member& member = ensemble.members[m];
    text += std::to_string(m);
    for (const ParameterValue& value : member.values) text += "," + quote(value.text);
    text += fmt::format(",{},{},{:.3f}", member.seed ? std::to_string(*member.seed) : "",
                        word_of(result.records[m].status), result.records[m].wall);
    for (const std::string& name : names)
      for (const std::string& value : diagnostics[m][name]) text += "," + value;
    text += '\n';
  }
  output::replace_file(result.directory / "members.csv", text);
}

}  // namespace pileus::study

#include "study/target_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/terminal.hpp"
#include "scene/problems.hpp"
#include "scene/value.hpp"
#include "study/study_files.hpp"

namespace pileus::study {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

/// Findings of a study, as study.json holds them.
struct Measured {
  fs::path path;
  Json json;
};

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ExitCode::usage, "--target-error: " + why);
}

double target_of(const std::string& text) {
  const scene::NumberResult number = scene::read_number(text, "1", {});
  if (!number.ok()) refuse(number.problem);
  if (!(number.value > 0)) refuse(fmt::format("'{}' is not greater than 0", text));
  return number.value;
}

std::optional<Json> read_json(const fs::path& path) {
  std::ifstream file(path);
  Json json = Json::parse(file, nullptr, false);
  if (!json.is_object() || !json.contains("points") || !json.contains("norms")) return std::nullopt;
  return json;
}

/// Files with findings: the one that is named, or all that are kept above the scene.
std::vector<fs::path> candidates(const TargetRequest& request) {
  if (!request.study.empty()) {
    fs::path path = request.study;
    if (fs::is_directory(path)) path /= "study.json";
    if (!fs::exists(path)) refuse(fmt::format("there are no findings '{}'", path.string()));
    return {path};
  }
  std::vector<fs::path> paths;
  fs::path folder = fs::weakly_canonical(request.scene_path).parent_path();
  for (;;) {
    const fs::path results = folder / "studies" / "results";
    if (fs::is_directory(results))
      for (const auto& entry : fs::directory_iterator(results))
        if (entry.path().extension() == ".json") paths.push_back(entry.path());
    if (folder == folder.parent_path()) break;
    folder = folder.parent_path();
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Keys that do not touch the solution.
bool is_beside_the_solution(const std::string& setting) {
  return setting.starts_with("output.") || setting.starts_with("scene.title") ||
         setting.starts_with("scene.name") || setting.starts_with("scene.description");
}

bool is_of_scene(const Measured& measured, const std::string& scene_path) {
  if (!measured.json.contains("scene")) return false;
  const fs::path scene = measured.path.parent_path() / measured.json.at("scene").get<std::string>();
  return fs::weakly_canonical(scene) == fs::weakly_canonical(scene_path);
}

std::vector<std::string> settings_of(const Json& json) {
  return json.value("settings", Json::array()).get<std::vector<std::string>>();
}

/// Whether the scene, as it is now, simulates with a point's settings what was measured.
bool is_as_measured(const Json& point, const std::string& scene_path) {
  try {
    return point.value("scene_sha256", "") == scene_fingerprint(scene_path, settings_of(point));
  } catch (const Error&) {  // a setting has no place in the scene any more
    return false;
  }
}

std::vector<Measured> measured_of(const TargetRequest& request) {
  std::vector<Measured> found;
  std::string changed;
  const std::vector<fs::path> paths = candidates(request);
  for (const fs::path& path : paths) {
    auto json = read_json(path);
    if (!json) continue;
    Measured measured{path, std::move(*json)};
    if (!is_of_scene(measured, request.scene_path)) continue;
    const std::vector<std::string> settings = settings_of(measured.json);
    if (!std::all_of(settings.begin(), settings.end(), is_beside_the_solution)) continue;
    Json current = Json::array();
    for (const Json& point : measured.json.at("points"))
      if (is_as_measured(point, request.scene_path)) current.push_back(point);
    if (current.empty()) {
      changed = path.string();
      continue;
    }
    measured.json["points"] = std::move(current);
    found.push_back(std::move(measured));
  }
  if (!found.empty()) return found;
  if (!changed.empty())
    refuse(
        fmt::format("the scene has changed since it was measured ({}); measure it again with "
                    "'pileus study'",
                    changed));
  refuse(
      fmt::format("nothing was measured for this scene ({}); make a study of it and run it with "
                  "'pileus study STUDY --keep', or name findings with --study",
                  paths.empty() ? "there are no findings in a folder studies/results above it"
                                : fmt::format("{} files with findings are of other scenes, or of "
                                              "this one changed",
                                              paths.size())));
}

void check_norm(const std::vector<Measured>& all, const std::string& norm) {
  std::set<std::string> names;
  for (const Measured& measured : all)
    for (const auto& [name, title] : measured.json.at("norms").items()) names.insert(name);
  if (names.count(norm) > 0) return;
  const std::vector<std::string> list(names.begin(), names.end());
  const std::string nearest = nearest_word(norm, list);
  refuse(fmt::format("no study of this scene measures '{}'{}", norm,
                     nearest.empty() ? "; there is " + scene::alternatives(list)
                                     : fmt::format("; did you mean '{}'?", nearest)));
}

void check_overrides(const TargetRequest& request) {
  for (const std::string& setting : request.overrides)
    if (!is_beside_the_solution(setting))
      refuse(
          fmt::format("the errors were measured without '--set {}'; leave it out, or leave out "
                      "--target-error",
                      setting));
}

struct Candidate {
  const Measured* measured;
  const Json* point;
  double error, cost;
};

std::vector<Candidate> points_with(const std::vector<Measured>& all, const std::string& norm) {
  std::vector<Candidate> points;
  for (const Measured& measured : all) {
    for (const Json& point : measured.json.at("points")) {
      const Json& errors = point.at("errors");
      if (!errors.contains(norm) || !errors.at(norm).at("high").is_number()) continue;
      if (!point.at("cost").at("value").is_number()) continue;
      points.push_back({&measured, &point, errors.at(norm).at("high").get<double>(),
                        point.at("cost").at("value").get<double>()});
    }
  }
  return points;
}

/// How busy the machine was with other things, where that shows: times are upper bounds then.
std::string disturbance(const Candidate& chosen) {
  constexpr double undisturbed = 1.1;  // of wall time over a thread's share of the processor time
  const auto number = [&](const char* name) {
    const auto entry = chosen.point->find(name);
    return entry != chosen.point->end() && entry->is_number() ? entry->get<double>() : 0.0;
  };
  const double core = number("core_time"), wall = number("wall_time");
  const double ratio = wall * chosen.measured->json.at("threads").get<int>() / core;
  if (!(core > 0 && ratio > undisturbed)) return "";
  return fmt::format(
      "  on a machine that was shared: it took {:.1f} times its processor time, which is an upper "
      "bound\n",
      ratio);
}

std::string describe(const Candidate& chosen, const std::string& norm) {
  const Json& json = chosen.measured->json;
  const Json& cost = json.at("cost");
  std::string settings;
  for (const std::string& setting : settings_of(*chosen.point))
    settings += " --set '" + setting + "'";
  return fmt::format(
      "{}: {} of {:.3g} for {} {} of {}\n"
      "  measured by the study '{}' ({}): {}, {} points, Pileus {} (commit {}), {}, threads: {}\n"
      "{}"
      "  as with{}\n",
      chosen.point->at("label").get<std::string>(), norm, chosen.error, format_value(chosen.cost),
      cost.at("unit").get<std::string>(), cost.at("name").get<std::string>(),
      json.at("title").get<std::string>(), chosen.measured->path.lexically_normal().string(),
      chosen.point->at("date").get<std::string>().substr(0, 10), json.at("points").size(),
      json.at("version").get<std::string>(),
      chosen.point->at("commit").get<std::string>().substr(0, 7),
      json.at("machine").get<std::string>(), json.at("threads").get<int>(), disturbance(chosen),
      settings);
}

}  // namespace

Choice choose_setting(const TargetRequest& request) {
  const double target = target_of(request.target);
  const std::vector<Measured> all = measured_of(request);
  check_norm(all, request.norm);
  check_overrides(request);
  const std::vector<Candidate> points = points_with(all, request.norm);
  const Candidate* cheapest = nullptr;
  const Candidate* best = nullptr;
  for (const Candidate& point : points) {
    if (best == nullptr || point.error < best->error) best = &point;
    if (point.error <= target && (cheapest == nullptr || point.cost < cheapest->cost))
      cheapest = &point;
  }
  if (cheapest == nullptr)
    refuse(fmt::format("no measured setting reaches '{}' in '{}'{}", request.target, request.norm,
                       best == nullptr
                           ? std::string()
                           : "; the most accurate is\n" + describe(*best, request.norm)));
  Choice choice;
  choice.overrides = settings_of(*cheapest->point);
  choice.explanation = describe(*cheapest, request.norm);
  return choice;
}

}  // namespace pileus::study

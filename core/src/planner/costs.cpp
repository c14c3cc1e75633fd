#include "planner/costs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

namespace pileus::planner {
namespace {

using Json = nlohmann::ordered_json;

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::string text_of(const Json& entry, const char* key) {
  return entry.contains(key) && entry.at(key).is_string() ? entry.at(key).get<std::string>()
                                                          : std::string();
}

}  // namespace

std::filesystem::path Costs::default_path() {
  std::filesystem::path folder;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
    folder = cache;
  else if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    folder = std::filesystem::path(home) / ".cache";
  if (folder.empty()) return folder;
  return folder / "pileus" / ("costs-" + host_name() + ".json");
}

/// The file is a cache that anybody may have written to: what is not as it should be is not there.
Costs Costs::read(const std::filesystem::path& path) {
  Costs costs;
  std::ifstream stream(path);
  if (!stream) return costs;
  const Json json = Json::parse(stream, nullptr, false);
  if (!json.is_object()) return costs;
  for (const auto& [part, entry] : json.items()) {
    if (!entry.is_object()) continue;
    constexpr const char* seconds = "core_seconds_per_parcel_step";
    Cost cost;
    if (entry.contains(seconds) && entry.at(seconds).is_number())
      cost.seconds = entry.at(seconds).get<double>();
    cost.scene = text_of(entry, "scene");
    cost.when = text_of(entry, "when");
    cost.commit = text_of(entry, "commit");
    if (cost.seconds > 0) costs.parts_[part] = cost;
  }
  return costs;
}

std::string Costs::text() const {
  Json json = Json::object();
  for (const auto& [part, cost] : parts_)
    json[part] = {{"core_seconds_per_parcel_step", cost.seconds},
                  {"scene", cost.scene},
                  {"when", cost.when},
                  {"commit", cost.commit}};
  return json.dump(2) + "\n";
}

const Cost* Costs::find(const std::string& part) const {
  const auto found = parts_.find(part);
  return found == parts_.end() ? nullptr : &found->second;
}

std::string core_part(const scene::Scene& scene) {
  return fmt::format("core {} {}", scene.domain.dimension,
                     scene.time.scheme == scene::RungeKutta::order4_stages5 ? "rk4" : "rk3");
}

std::string operator_part(const OperatorPlan& op, bool everything) {
  std::vector<std::string> on = op.on;
  if (everything) {
    on.insert(on.end(), op.watched.begin(), op.watched.end());
    on.insert(on.end(), op.off.begin(), op.off.end());
  }
  std::sort(on.begin(), on.end());
  return fmt::format("{} {} ({})", op.id, op.version, fmt::join(on, ", "));
}

namespace {

/// What leaving effects out saves per parcel and step; nothing if a cost of it is unknown.
std::optional<double> seconds_left_out(const Costs& costs, const Plan& plan) {
  double saved = 0;
  for (const OperatorPlan& op : plan.operators) {
    if (!op.leaves_out()) continue;
    const Cost* all = costs.find(operator_part(op, true));
    const Cost* own = op.present ? costs.find(operator_part(op)) : nullptr;
    if (all == nullptr || (op.present && own == nullptr)) return std::nullopt;
    saved += all->seconds - (op.present ? own->seconds : 0.0);
  }
  return saved;
}

}  // namespace

void predict_time(const scene::Scene& scene, const Costs& costs, Plan& plan) {
  plan.flow.seconds_per_step.reset();
  plan.flow.steps.reset();
  plan.flow.seconds_left_out = seconds_left_out(costs, plan);
  if (scene.time.fixed)
    plan.flow.steps = static_cast<std::uint64_t>(std::ceil(scene.time.end / *scene.time.fixed));
  std::vector<std::string> parts = {core_part(scene)};
  for (const OperatorPlan& op : plan.operators)
    if (op.present) parts.push_back(operator_part(op));
  double seconds = 0;
  for (const std::string& part : parts) {
    const Cost* cost = costs.find(part);
    if (cost == nullptr) {
      plan.flow.cost_source = fmt::format(
          "the cost of '{}' has not been measured on this machine; 'pileus plan {} --measure' does",
          part, scene.path);
      return;
    }
    seconds += cost->seconds;
    if (part == parts.front())
      plan.flow.cost_source =
          fmt::format("measured with {} on {}, {}", cost->scene, host_name(), cost->when);
  }
  plan.flow.seconds_per_step = seconds * static_cast<double>(plan.flow.parcels);
}

}  // namespace pileus::planner

#include "model/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>

#include "planner/plan_text.hpp"

namespace pileus::model {

std::map<std::string, std::uint64_t> run_seeds(const scene::Scene& scene) {
  return {{"scene", scene.seed}, {"parcels", scene.parcels.seed}};
}

output::Provenance run_provenance(const scene::Scene& scene, const planner::Plan& plan) {
  const BuildRecord& build = build_record();
  output::Provenance provenance;
  provenance.title = scene.title.empty() ? scene.name : scene.title;
  provenance.source = fmt::format("Pileus {} ({})", build.version, build.commit);
  provenance.history = fmt::format("{:%Y-%m-%dT%H:%M:%SZ} pileus run {}",
                                   fmt::gmtime(std::time(nullptr)), scene.path);
  provenance.scene = scene.resolved_yaml;
  provenance.seeds = run_seeds(scene);
  provenance.attributes["plan"] = planner::plan_json(plan);
  return provenance;
}

void describe_origin(const scene::Scene& scene, output::Summary& summary) {
  const BuildRecord& build = build_record();
  summary.scene = scene.name;
  summary.title = scene.title;
  summary.version = build.version;
  summary.commit = build.commit;
  summary.compiler = build.compiler;
  for (const LibraryVersion& library : build.libraries)
    summary.libraries[std::string(library.name)] = std::string(library.version);
  summary.seeds = run_seeds(scene);
}

}  // namespace pileus::model

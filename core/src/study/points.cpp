#include "study/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/nearest_word.hpp"
#include "base/sha256.hpp"
#include "base/units.hpp"
#include "base/version.hpp"
#include "model/record.hpp"
#include "scene/read_scene.hpp"
#include "scene/tree.hpp"
#include "study/scene_settings.hpp"

namespace pileus::study {

namespace {

constexpr std::size_t most_points = 10000;

/// The rungs an operator declares for a parameter; none when it is no knob.
std::vector<Rung> declared_ladder(const pileus_parameter& parameter, const std::string& key,
                                  const scene::Location& where) {
  std::vector<Rung> ladder;
  for (const double* rung = parameter.ladder; rung != nullptr && !std::isnan(*rung); ++rung) {
    const std::string text = shortest(*rung);
    ladder.push_back({text, *rung, {text_setting(key, text, where)}});
  }
  return ladder;
}

/// Ladders of knobs without values, and of `operator_knobs`, from the operators' declarations.
std::vector<Knob> complete_knobs(const Study& study, const scene::Scene& base,
                                 scene::Problems& problems) {
  std::vector<Knob> knobs = study.knobs;
  std::vector<std::string> declared;
  const auto operators = operators_of(base, study.scene_path(), problems);
  for (const coupling::OperatorEntry& entry : operators) {
    for (const pileus_parameter& parameter : entry.table->parameters) {
      if (parameter.knob == 0 || parameter.ladder == nullptr) continue;
      const std::string key = fmt::format("operators.{}.{}", entry.name, parameter.name);
      declared.push_back(key);
      const auto given = std::find_if(knobs.begin(), knobs.end(), [&](const Knob& knob) {
        return knob.keys == std::vector<std::string>{key};
      });
      if (given != knobs.end()) {
        if (given->ladder.empty()) given->ladder = declared_ladder(parameter, key, given->where);
      } else if (study.operator_knobs) {
        Knob knob;
        knob.name = parameter.name;
        knob.keys = {key};
        knob.where = {study.path, 0, 0};
        knob.ladder = declared_ladder(parameter, key, knob.where);
        knobs.push_back(std::move(knob));
      }
    }
  }
  for (const Knob& knob : knobs) {
    if (!knob.ladder.empty() || knob.keys.empty()) continue;
    problems.add(
        knob.where,
        fmt::format("the knob '{}' has no 'values', and no operator of the scene declares "
                    "a ladder for '{}'{}",
                    knob.name, knob.keys.front(),
                    declared.empty() ? std::string()
                                     : "; there is one for " + scene::alternatives(declared)));
  }
  if (study.operator_knobs && declared.empty())
    problems.add({study.path, 1, 1},
                 "'operator_knobs' is on, but no operator of the scene declares a knob");
  return knobs;
}

std::string label_of(const std::vector<Knob>& knobs, const std::vector<int>& rungs,
                     std::size_t except) {
  std::string label;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    if (k == except || rungs[k] < 0) continue;
    const std::string& word = knobs[k].ladder[static_cast<std::size_t>(rungs[k])].label;
    // A bare number says little beside those of other knobs.
    const auto quantity = split_quantity(word);
    const bool named =
        knobs.size() > 1 && quantity && (quantity->unit.empty() || is_unit(quantity->unit));
    label += (label.empty() ? "" : ", ") + (named ? knobs[k].name + " " + word : word);
  }
  return label;
}

Point make_point(const std::vector<Knob>& knobs, std::vector<int> rungs) {
  Point point;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    if (rungs[k] < 0) continue;
    const Rung& rung = knobs[k].ladder[static_cast<std::size_t>(rungs[k])];
    point.settings.insert(point.settings.end(), rung.settings.begin(), rung.settings.end());
  }
  point.label = label_of(knobs, rungs, knobs.size());
  point.rungs = std::move(rungs);
  return point;
}

void add_product(Layout& layout) {
  const std::vector<Knob>& knobs = layout.knobs;
  std::vector<int> rungs(knobs.size(), 0);
  for (bool more = true; more && layout.points.size() < most_points;) {
    layout.points.push_back(make_point(knobs, rungs));
    more = false;
    for (std::size_t k = knobs.size(); k-- > 0 && !more;) {
      more = ++rungs[k] < static_cast<int>(knobs[k].ladder.size());
      if (!more) rungs[k] = 0;
    }
  }
  for (std::size_t along = 0; along < knobs.size(); ++along) {
    for (std::size_t p = 0; p < layout.points.size(); ++p) {
      if (layout.points[p].rungs[along] != 0) continue;  // where the curve begins
      KnobCurve curve{label_of(knobs, layout.points[p].rungs, along), along, {}};
      for (std::size_t q = 0; q < layout.points.size(); ++q) {
        std::vector<int> begin = layout.points[q].rungs;
        begin[along] = 0;
        if (begin == layout.points[p].rungs) curve.points.push_back(q);
      }
      layout.curves.push_back(std::move(curve));
    }
  }
}

void add_one_at_a_time(Layout& layout) {
  for (std::size_t k = 0; k < layout.knobs.size(); ++k) {
    KnobCurve curve{layout.knobs.size() > 1 ? layout.knobs[k].name : "", k, {}};
    for (std::size_t r = 0; r < layout.knobs[k].ladder.size(); ++r) {
      std::vector<int> rungs(layout.knobs.size(), -1);
      rungs[k] = static_cast<int>(r);
      curve.points.push_back(layout.points.size());
      layout.points.push_back(make_point(layout.knobs, std::move(rungs)));
    }
    layout.curves.push_back(std::move(curve));
  }
}

/// What every run of a study does without: outputs that no error is measured from, on which steps
/// would have to land.
void add_outputs(const Study& study, const scene::Scene& scene,
                 std::vector<scene::Setting>& settings) {
  const scene::Location where{study.path, 0, 0};
  std::string fields;
  for (const ErrorNorm& norm : study.errors)
    if (!norm.field.empty() && fields.find(norm.field) == std::string::npos)
      fields += (fields.empty() ? "" : ", ") + norm.field;
  settings.push_back(text_setting("output.parcels.every", "0", where));
  settings.push_back(text_setting("output.profiles.every", "0", where));
  settings.push_back(
      text_setting("output.fields.every", fields.empty() ? "0" : shortest(scene.time.end), where));
  if (fields.empty()) return;
  scene::Setting variables{"output.fields.variables", {}, where};
  variables.value.kind = scene::Node::Kind::list;
  variables.value.where = where;
  for (const ErrorNorm& norm : study.errors)
    if (!norm.field.empty())
      variables.value.items.push_back(text_setting("", norm.field, where).value);
  settings.push_back(std::move(variables));
}

PlannedRun plan_run(const Study& study, const Point& point, std::optional<std::uint64_t> seed,
                    scene::Problems& problems) {
  PlannedRun run;
  run.seed = seed;
  std::vector<scene::Setting> settings = study.settings;
  settings.insert(settings.end(), point.settings.begin(), point.settings.end());
  if (seed)
    for (const std::string& key : study.seed_keys)
      settings.push_back(text_setting(key, std::to_string(*seed), {study.path, 0, 0}));
  const std::size_t before = problems.size();
  scene::Scene scene = scene::read_scene_with(study.scene_path(), settings, problems);
  if (problems.size() == before) {
    add_outputs(study, scene, settings);
    scene = scene::read_scene_with(study.scene_path(), settings, problems);
  }
  if (problems.size() == before) operators_of(scene, study.scene_path(), problems);
  run.overrides = assignments(settings);
  run.resolved = scene.resolved_yaml;
  run.key = sha256_hex(run.resolved + std::string(build_record().version));
  return run;
}

/// The same mistake shows up in every point that makes it.
void add_new(const scene::Problems& found, scene::Problems& problems) {
  for (const scene::Problem& one : found.list()) {
    const auto same = [&](const scene::Problem& other) { return is_same(one, other); };
    if (std::none_of(problems.list().begin(), problems.list().end(), same)) problems.add(one);
  }
}

void plan_runs(const Study& study, Point& point, scene::Problems& problems) {
  scene::Problems found;
  if (study.experiment == Study::Experiment::shape_integrators) {
    PlannedRun run;
    run.key = sha256_hex(point.label + std::string(build_record().version));
    point.runs.push_back(std::move(run));
    return;
  }
  if (study.seeds.empty()) point.runs.push_back(plan_run(study, point, {}, found));
  for (const std::uint64_t seed : study.seeds)
    point.runs.push_back(plan_run(study, point, seed, found));
  add_new(found, problems);
}

/// The point that others are compared with: one of the study's, or one more.
void add_finest(const Study& study, Layout& layout, scene::Problems& problems) {
  std::vector<int> last;
  for (const Knob& knob : layout.knobs) last.push_back(static_cast<int>(knob.ladder.size()) - 1);
  Point finest = make_point(layout.knobs, std::move(last));
  if (!study.finest.empty()) {
    finest.settings = study.finest;
    finest.rungs.assign(layout.knobs.size(), -1);
  }
  plan_runs(study, finest, problems);
  for (std::size_t p = 0; p < layout.points.size(); ++p)
    if (layout.points[p].runs.front().key == finest.runs.front().key) layout.finest = p;
  if (layout.finest) return;
  finest.only_reference = true;
  finest.label = "finest";
  layout.finest = layout.points.size();
  layout.points.push_back(std::move(finest));
}

void check_norms(const Study& study, scene::Problems& problems) {
  const std::vector<std::string>& words = model::known_statistics();
  for (const ErrorNorm& norm : study.errors) {
    if (std::find(words.begin(), words.end(), norm.statistic) != words.end()) continue;
    const std::string nearest = nearest_word(norm.statistic, words);
    problems.add(norm.where,
                 fmt::format("there is no statistic '{}'{}", norm.statistic,
                             nearest.empty() ? "; there is " + scene::alternatives(words)
                                             : fmt::format("; did you mean '{}'?", nearest)));
  }
}

}  // namespace

Layout lay_out(const Study& study, scene::Problems& problems) {
  Layout layout;
  layout.knobs = study.knobs;
  check_norms(study, problems);
  if (study.experiment == Study::Experiment::scene) {
    const std::size_t before = problems.size();
    const scene::Scene base = scene::read_scene_with(study.scene_path(), study.settings, problems);
    if (problems.size() > before) return layout;
    layout.knobs = complete_knobs(study, base, problems);
    if (problems.size() > before) return layout;
  }
  if (study.combine == Study::Combine::product)
    add_product(layout);
  else
    add_one_at_a_time(layout);
  if (layout.points.size() >= most_points) {
    problems.add({study.path, 1, 1}, fmt::format("the study has {} points or more; combine its "
                                                 "knobs one_at_a_time, or shorten their ladders",
                                                 most_points));
    return layout;
  }
  for (Point& point : layout.points) plan_runs(study, point, problems);
  if (study.needs_finest() && problems.empty()) add_finest(study, layout, problems);
  return layout;
}

}  // namespace pileus::study

#include "study/sweep_members.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "base/sha256.hpp"
#include "base/units.hpp"
#include "base/version.hpp"
#include "model/plan_run.hpp"
#include "scene/placed_error.hpp"
#include "scene/read_scene.hpp"
#include "study/scene_settings.hpp"
#include "study/study_knobs.hpp"

namespace pileus::study {

namespace {

constexpr std::size_t most_members = 100000;

/// One way to set some of the parameters.
struct Choice {
  std::vector<scene::Setting> settings;
  std::vector<std::pair<std::size_t, ParameterValue>> values;  // by number of the parameter
  std::optional<std::uint64_t> seed;
};

/// Columns that the lists and tables of members and ensemble.nc have of their own.
constexpr std::array<const char*, 7> own_columns = {"index",  "member", "seed",     "status",
                                                    "sha256", "wall_s", "wall_time"};

bool is_own_column(const std::string& name) {
  return std::find(own_columns.begin(), own_columns.end(), name) != own_columns.end();
}

/// Choices of which every member has one.
using Source = std::vector<Choice>;

ParameterValue value_of(const scene::Node& node) {
  ParameterValue value{label_of(node), not_a_number, {}};
  if (node.kind != scene::Node::Kind::scalar) return value;
  if (const auto written = split_quantity(node.text)) {
    value.number = written->number;
    value.unit = written->unit;
  }
  return value;
}

class Sources {
 public:
  Sources(Ensemble& ensemble, scene::Problems& problems)
      : ensemble_(ensemble), problems_(problems) {
    for (const Knob& knob : ensemble.sweep.product) add_product(knob);
    if (!ensemble.sweep.list.empty()) add_list();
    if (ensemble.sweep.sample.count > 0) add_sample();
    add_seeds();
  }

  std::size_t count() const {
    std::size_t product = 1;
    for (const Source& source : sources_) product = std::min(product * source.size(), most_members);
    return product;
  }

  /// The choices of a member, one per source; the last source varies fastest.
  std::vector<const Choice*> choices_of(std::size_t member) const {
    std::vector<const Choice*> choices(sources_.size());
    for (std::size_t s = sources_.size(); s-- > 0;) {
      choices[s] = &sources_[s][member % sources_[s].size()];
      member /= sources_[s].size();
    }
    return choices;
  }

 private:
  /// A key is varied by one parameter, or by the seed, only: of two, one would be without effect.
  void refuse_varied_twice(const std::vector<std::string>& keys, const scene::Location& where) {
    for (const Parameter& other : ensemble_.parameters)
      for (const std::string& key : keys)
        if (std::find(other.keys.begin(), other.keys.end(), key) != other.keys.end())
          problems_.add(where, fmt::format("the key '{}' is varied twice", key));
  }

  /// Declares a parameter.
  std::size_t add_parameter(std::string name, const std::vector<std::string>& keys,
                            const scene::Location& where) {
    std::vector<Parameter>& all = ensemble_.parameters;
    refuse_varied_twice(keys, where);
    const auto taken = [&](const std::string& word) {
      return std::any_of(all.begin(), all.end(),
                         [&](const Parameter& other) { return other.name == word; });
    };
    // Last words may be alike, or mean something else in tables: scene.seed, parcels.seed.
    const bool is_last_word = !keys.empty() && name == last_word(keys.front());
    if (!keys.empty() && (taken(name) || (is_last_word && is_own_column(name))))
      name = keys.front();
    if (is_own_column(name))
      problems_.add(where,
                    fmt::format("no parameter can be called '{}', as a column that all tables "
                                "of members have; give it another 'name'",
                                name));
    if (taken(name))
      problems_.add(where,
                    fmt::format("two parameters are called '{}'; give one another 'name'", name));
    all.push_back({std::move(name), keys, where});
    return all.size() - 1;
  }

  void add_product(const Knob& knob) {
    if (knob.ladder.empty()) return;  // a problem that the reader has reported
    const std::size_t parameter = add_parameter(knob.name, knob.keys, knob.where);
    Source source;
    for (const Rung& rung : knob.ladder) {
      ParameterValue value{rung.label, rung.number, {}};
      if (knob.numbers.empty() && rung.settings.size() == 1 && knob.labels.empty())
        value = value_of(rung.settings.front().value);
      source.push_back({rung.settings, {{parameter, std::move(value)}}, {}});
    }
    sources_.push_back(std::move(source));
  }

  void add_list() {
    std::vector<std::string> keys;
    std::vector<std::size_t> numbers;
    Source source;
    for (const ListedSettings& listed : ensemble_.sweep.list) {
      Choice choice{listed.settings, {}, {}};
      for (const scene::Setting& setting : listed.settings) {
        const auto known = std::find(keys.begin(), keys.end(), setting.key);
        if (known == keys.end()) {
          keys.push_back(setting.key);
          numbers.push_back(add_parameter(last_word(setting.key), {setting.key}, setting.where));
          choice.values.emplace_back(numbers.back(), value_of(setting.value));
        } else {
          choice.values.emplace_back(numbers[static_cast<std::size_t>(known - keys.begin())],
                                     value_of(setting.value));
        }
      }
      source.push_back(std::move(choice));
    }
    sources_.push_back(std::move(source));
  }

  void add_sample() {
    const SamplePlan& sample = ensemble_.sweep.sample;
    std::vector<std::size_t> numbers;
    for (const SampleRange& range : sample.ranges)
      numbers.push_back(add_parameter(range.name, {range.key}, range.where));
    Source source;
    for (const std::vector<double>& point :
         sample_unit_cube(sample.method, static_cast<std::size_t>(sample.count),
                          sample.ranges.size(), sample.seed)) {
      Choice choice;
      for (std::size_t r = 0; r < point.size(); ++r) {
        const SampleRange& range = sample.ranges[r];
        choice.settings.push_back(
            text_setting(range.key, range.value_at(point[r]), range.low_text.where));
        choice.values.emplace_back(numbers[r], value_of(choice.settings.back().value));
      }
      source.push_back(std::move(choice));
    }
    sources_.push_back(std::move(source));
  }

  void add_seeds() {
    const Sweep& sweep = ensemble_.sweep;
    if (sweep.seeds.empty()) return;
    refuse_varied_twice(sweep.seed_keys, sweep.seeds_where);
    Source source;
    for (const std::uint64_t seed : sweep.seeds) {
      Choice choice;
      choice.seed = seed;
      for (const std::string& key : sweep.seed_keys)
        choice.settings.push_back(text_setting(key, std::to_string(seed), {sweep.path, 0, 0}));
      source.push_back(std::move(choice));
    }
    sources_.push_back(std::move(source));
  }

  Ensemble& ensemble_;
  scene::Problems& problems_;
  std::vector<Source> sources_;
};

std::string label_of(const Ensemble& ensemble, const Member& member) {
  std::string label;
  const auto add = [&](const std::string& word) { label += (label.empty() ? "" : ", ") + word; };
  for (std::size_t p = 0; p < member.values.size(); ++p)
    if (!member.values[p].text.empty())
      add(ensemble.parameters[p].name + " " + member.values[p].text);
  if (member.seed) add(fmt::format("seed {}", *member.seed));
  return label;
}

/// What `pileus run` would refuse before its first step: operators that lack something, effects
/// that nobody provides.
void check_plan(const scene::Scene& scene, const std::string& path, scene::Problems& problems) {
  std::vector<coupling::OperatorEntry> operators = operators_of(scene, path, problems);
  if (!problems.empty()) return;
  try {
    model::plan_run(scene, std::move(operators));
  } catch (const scene::PlacedError& error) {
    problems.add(error.where(), error.text());
  } catch (const Error& error) {
    if (error.code() != ExitCode::usage) throw;
    problems.add({path, 0, 0}, error.what());
  }
}

/// A member without its scene.
Member name_member(const Ensemble& ensemble, const Sources& sources, std::size_t index) {
  Member member;
  member.index = index;
  member.values.resize(ensemble.parameters.size());
  std::vector<scene::Setting> settings = ensemble.sweep.settings;
  for (const Choice* choice : sources.choices_of(index)) {
    settings.insert(settings.end(), choice->settings.begin(), choice->settings.end());
    for (const auto& [parameter, value] : choice->values) member.values[parameter] = value;
    if (choice->seed) member.seed = choice->seed;
  }
  member.label = label_of(ensemble, member);
  member.settings = std::move(settings);
  member.overrides = assignments(member.settings);
  return member;
}

void read_member(const Ensemble& ensemble, Member& member, bool plan, scene::Problems& problems) {
  const std::string path = ensemble.sweep.scene_path();
  const scene::Scene scene = scene::read_scene_with(path, member.settings, problems);
  if (problems.empty() && plan) check_plan(scene, path, problems);
  member.resolved = scene.resolved_yaml;
  member.key = sha256_hex(member.resolved + std::string(build_record().version));
  member.series_every = scene.output.series.every;
  member.profiles_every = scene.output.profiles.every;
}

/// Mistakes of members, each once, with the members that make it.
class MistakesOfMembers {
 public:
  void add(std::size_t member, const scene::Problems& found) {
    for (const scene::Problem& one : found.list()) {
      auto known = std::find_if(all_.begin(), all_.end(),
                                [&](const Mistake& other) { return is_same(other.problem, one); });
      if (known == all_.end()) known = all_.insert(all_.end(), {one, {}});
      known->members.push_back(member);
    }
  }
  void report(scene::Problems& problems, std::size_t of) {
    for (Mistake& mistake : all_) {
      mistake.problem.text += " " + who(mistake.members, of);
      problems.add(mistake.problem);
    }
  }

 private:
  struct Mistake {
    scene::Problem problem;
    std::vector<std::size_t> members;
  };

  static std::string who(const std::vector<std::size_t>& members, std::size_t of) {
    if (members.size() == of) return of == 1 ? "(member 0000)" : "(all members)";
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(members.size(), 4); ++i)
      text += (i == 0 ? "" : ", ") + index_text(members[i]);
    if (members.size() > 4) text += fmt::format(" and {} more", members.size() - 4);
    return fmt::format("(member{} {})", members.size() > 1 ? "s" : "", text);
  }

  std::vector<Mistake> all_;
};

}  // namespace

std::string index_text(std::size_t index) {
  return fmt::format("{:04}", index);
}

Ensemble lay_out_members(const std::string& path, scene::Problems& problems,
                         const Scrutiny& scrutiny) {
  Ensemble ensemble;
  ensemble.sweep = read_sweep(path, problems);
  if (!problems.empty()) return ensemble;
  const Sources sources(ensemble, problems);
  // Read once by itself: this remembers the text that messages quote.
  if (problems.empty())
    scene::read_scene_with(ensemble.sweep.scene_path(), ensemble.sweep.settings, problems);
  if (sources.count() >= most_members)
    problems.add({path, 1, 1}, fmt::format("the sweep has {} members or more", most_members));
  if (!problems.empty()) return ensemble;
  MistakesOfMembers mistakes;
  const std::size_t seeds = std::max<std::size_t>(1, ensemble.sweep.seeds.size());
  for (std::size_t m = 0; m < sources.count(); ++m) {
    Member& member = ensemble.members.emplace_back(name_member(ensemble, sources, m));
    if (scrutiny.only && *scrutiny.only != m) continue;
    scene::Problems found;
    // Another seed makes no other plan.
    const bool plan = scrutiny.plans && (m % seeds == 0 || scrutiny.only);
    read_member(ensemble, member, plan, found);
    mistakes.add(m, found);
  }
  mistakes.report(problems, ensemble.members.size());
  return ensemble;
}

std::optional<NumberedParameter> numbers_of(const Ensemble& ensemble, std::size_t parameter) {
  NumberedParameter numbered;
  for (const Member& member : ensemble.members)
    if (numbered.unit.empty()) numbered.unit = member.values[parameter].unit;
  for (const Member& member : ensemble.members) {
    const ParameterValue& value = member.values[parameter];
    if (value.text.empty()) {
      numbered.numbers.push_back(not_a_number);
      continue;
    }
    if (std::isnan(value.number) || value.unit.empty() != numbered.unit.empty())
      return std::nullopt;
    const UnitConversion converted = value.unit == numbered.unit
                                         ? UnitConversion{value.number, {}}
                                         : convert_units(value.number, value.unit, numbered.unit);
    if (!converted.ok()) return std::nullopt;
    numbered.numbers.push_back(converted.value);
  }
  return numbered;
}

}  // namespace pileus::study

#include "study/study_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/nearest_word.hpp"
#include "scene/reader.hpp"
#include "scene/schema.hpp"
#include "study/file_keys.hpp"
#include "study/study_knobs.hpp"

namespace pileus::study {

using scene::Entry;
using scene::Node;
using scene::Reader;

namespace {

const scene::DocumentKind study_kind = {"study", "'knobs' and 'errors'", "scene:, knobs:, errors:"};

/// A list of names that a message may suggest, or a complaint about one that is not in it.
template <class Names>
void require_known(Reader& reader, const scene::Location& where, const std::string& what,
                   const std::string& word, const Names& names) {
  if (std::find(names.begin(), names.end(), word) != names.end()) return;
  const std::vector<std::string> list(names.begin(), names.end());
  const std::string nearest = nearest_word(word, list);
  reader.problems().add(where,
                        fmt::format("no {} of this study is called '{}'{}", what, word,
                                    !nearest.empty() ? fmt::format("; did you mean '{}'?", nearest)
                                    : list.empty()   ? std::string("; it has none")
                                                     : "; there is " + scene::alternatives(list)));
}

std::vector<std::string> norm_names(const Study& study) {
  std::vector<std::string> names;
  for (const ErrorNorm& norm : study.errors) names.push_back(norm.name);
  return names;
}

std::vector<std::string> knob_names(const Study& study) {
  std::vector<std::string> names;
  for (const Knob& knob : study.knobs) names.push_back(knob.name);
  return names;
}

/// A mapping from names to numbers.
scene::Key numbers_key(const std::string& name,
                       std::map<std::string, double> PublishedPoint::*member,
                       const std::string& doc) {
  scene::Key key;
  key.name = name;
  key.type = scene::KeyType::custom;
  key.doc = doc;
  key.read = [member, name](Reader& reader, const Entry& entry, void* object) {
    if (entry.value.kind != Node::Kind::mapping)
      reader.problem(entry.value, fmt::format("'{}' is a mapping from names to numbers, found {}",
                                              name, describe(entry.value)));
    scene::Key number;
    for (const Entry& one : entry.value.entries) {
      number.name = one.key;
      double value = 0;
      if (reader.number(one.value, number, value))
        (static_cast<PublishedPoint*>(object)->*member)[one.key] = value;
    }
  };
  key.write = [](const void*) -> scene::Json { return nullptr; };
  key.schema = [] {
    return scene::Json{
        {"type", "object"},
        {"additionalProperties", {{"type", scene::Json::array({"number", "string"})}}}};
  };
  return key;
}

void complete_norm(Reader& reader, const Node& node, void* object) {
  auto& norm = *static_cast<ErrorNorm*>(object);
  norm.where = node.where;
  if (norm.title.empty()) norm.title = norm.name;
  if (norm.diagnostic.empty() == norm.field.empty())
    reader.problem(node, "an error is measured either of a 'diagnostic' or of a 'field'");
  if (!norm.file.empty()) {
    norm.file =
        (std::filesystem::path(node.where.file).parent_path() / norm.file).lexically_normal();
    if (norm.diagnostic.empty() || norm.column.empty())
      reader.problem(node, "published data ('file') need a 'diagnostic' and a 'column'");
  }
  if (norm.bins > 0 && (norm.field.empty() || !(norm.high > norm.low)))
    reader.problem(node, "a histogram ('bins') needs a 'field', and 'low' below 'high'");
}

const scene::Table& norm_table() {
  static const scene::Table table =
      {.path = "errors",
       .doc = "How wrong a run is: numbers that are zero for a perfect one.",
       .keys =
           {scene::value("name", &ErrorNorm::name, "1", "Name in tables and of --norm.").must(),
            scene::value("title", &ErrorNorm::title, "1", "Label of the axis in pictures.")
                .otherwise("the name"),
            scene::value("diagnostic", &ErrorNorm::diagnostic, "1",
                         "Diagnostic of the run whose statistic is compared.")
                .otherwise("none"),
            scene::value("statistic", &ErrorNorm::statistic, "1",
                         "Which number of its series, as in the section 'expect' of scenes."),
            scene::value("at", &ErrorNorm::at, "s", "Take it at this simulated time.")
                .otherwise("the end"),
            scene::value("from", &ErrorNorm::from, "s", "Statistics begin at this simulated time.")
                .otherwise("the start"),
            scene::choice("reference", &ErrorNorm::reference, {"value", "finest"},
                          "What it is compared with: the number 'exact', or the finest run."),
            scene::value("exact", &ErrorNorm::exact, "1", "The right number, in SI."),
            scene::value("relative", &ErrorNorm::relative,
                         "1", "Divide by the magnitude of the reference."),
            scene::value("file", &ErrorNorm::file, "1",
                         "CSV file of published data, relative to the study: the error is the "
                         "r.m.s. difference of the diagnostic at its times over the r.m.s. of the "
                         "data.")
                .otherwise("none"),
            scene::value("time_column", &ErrorNorm::time_column, "1", "Its column of times (s)."),
            scene::value("column", &ErrorNorm::column, "1", "Its column of values (SI).")
                .otherwise("none"),
            scene::value(
                "field",
                &ErrorNorm::field, "1",
                "Gridded field whose final state is compared with the finest run's: r.m.s. "
                "difference over the r.m.s. deviation of the finest from its mean.")
                .otherwise("none"),
            scene::value("bins", &ErrorNorm::bins, "1",
                         "Compare the field's histogram instead, of this many bins between 'low' "
                         "and 'high': r.m.s. difference of the densities over their r.m.s.")
                .at_least(0)
                .at_most(100000),
            scene::value("low", &ErrorNorm::low, "1", "Lower edge of the histogram, in SI."),
            scene::value("high", &ErrorNorm::high, "1", "Upper edge of the histogram, in SI."),
            scene::value("slopes", &ErrorNorm::slopes, "1",
                         "Orders drawn as guides beside the points.")},
       .other = {},
       .finish = complete_norm,
       .write_other = {},
       .amend_schema = {}};
  return table;
}

const scene::Table& published_table() {
  static const scene::Table table = {
      .path = "published",
      .doc = "Results of others, drawn and listed beside the study's own.",
      .keys =
          {scene::value("label", &PublishedPoint::label, "1", "Name of the curve.").must(),
           numbers_key("errors", &PublishedPoint::errors, "The errors, by norm."),
           scene::value("cost", &PublishedPoint::cost, "1",
                        "What it cost, in the study's unit of cost.")
               .otherwise("unknown"),
           numbers_key("numbers", &PublishedPoint::numbers,
                       "Where it stands, by knob: a number on the knob's axis."),
           scene::value("source", &PublishedPoint::source, "1", "Where it was published.").must()},
      .other = {},
      .finish = [](Reader&, const Node& node,
                   void* object) { static_cast<PublishedPoint*>(object)->where = node.where; },
      .write_other = {},
      .amend_schema = {}};
  return table;
}

scene::Key points_key() {
  scene::Key key;
  key.name = "points";
  key.type = scene::KeyType::custom;
  key.doc = "Which points are held to it: a label for some knobs.";
  key.default_doc = "all";
  key.read = [](Reader& reader, const Entry& entry, void* object) {
    if (entry.value.kind != Node::Kind::mapping)
      reader.problem(entry.value,
                     fmt::format("'points' is a mapping from knobs to labels, found {}",
                                 describe(entry.value)));
    for (const Entry& one : entry.value.entries)
      reader.text(one.value, one.key, static_cast<StudyExpectation*>(object)->points[one.key]);
  };
  key.write = [](const void*) -> scene::Json { return nullptr; };
  key.schema = [] { return scene::Json{{"type", "object"}}; };
  return key;
}

const scene::Table& expect_table() {
  static const scene::Table table = {
      .path = "expect",
      .doc = "Bounds that the study's errors keep, whatever the machine; times are never judged.",
      .keys = {scene::value("error", &StudyExpectation::norm, "1", "Name of the norm.").must(),
               scene::choice("of", &StudyExpectation::of, {"error", "order"},
                             "The error itself at every point, or its order along a knob: how fast "
                             "the error falls from the coarsest to the finest value."),
               scene::value("along", &StudyExpectation::along, "1", "The knob of the order.")
                   .otherwise("the first"),
               points_key(),
               scene::value("at_least", &StudyExpectation::low, "1", "Lowest value allowed.")
                   .otherwise("none"),
               scene::value("at_most", &StudyExpectation::high, "1", "Highest value allowed.")
                   .otherwise("none"),
               scene::value("source", &StudyExpectation::source, "1", "Where the bound comes from.")
                   .must()},
      .other = {},
      .finish =
          [](Reader& reader, const Node& node, void* object) {
            auto& e = *static_cast<StudyExpectation*>(object);
            e.where = node.where;
            if (!e.low && !e.high)
              reader.problem(node, "an expectation needs 'at_least', 'at_most' or both");
          },
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const scene::Table& identity_table() {
  static const scene::Table table =
      identity_of<Study>("study", "What the study is called and what it asks.",
                         "Name of its files.", "What it asks, at length.");
  return table;
}

/// Seeds are a list of whole numbers beyond what `int` holds.
scene::Key seeds_key() {
  scene::Key key;
  key.name = "seeds";
  key.type = scene::KeyType::custom;
  key.doc =
      "Every point is run once with each of these seeds, where randomness matters; errors are "
      "their mean, with the lowest and highest as bars.";
  key.default_doc = "the scene's own";
  key.read = [](Reader& reader, const Entry& entry, void* object) {
    read_seeds(reader, entry.value, static_cast<Study*>(object)->seeds);
  };
  key.write = [](const void*) -> scene::Json { return nullptr; };
  key.schema = [] { return list_of_seeds(); };
  return key;
}

/// Names that refer to one another within the file.
void check_references(Reader& reader, Study& study) {
  const std::vector<std::string> norms = norm_names(study), knobs = knob_names(study);
  for (const PublishedPoint& point : study.published) {
    for (const auto& [norm, value] : point.errors)
      require_known(reader, point.where, "error", norm, norms);
    for (const auto& [knob, value] : point.numbers)
      require_known(reader, point.where, "knob", knob, knobs);
  }
  for (StudyExpectation& e : study.expect) {
    require_known(reader, e.where, "error", e.norm, norms);
    if (e.along.empty() && !knobs.empty()) e.along = knobs.front();
    require_known(reader, e.where, "knob", e.along, knobs);
    for (const auto& [knob, label] : e.points) {
      require_known(reader, e.where, "knob", knob, knobs);
      for (const Knob& one : study.knobs) {
        if (one.name != knob) continue;
        std::vector<std::string> labels;
        for (const Rung& rung : one.ladder) labels.push_back(rung.label);
        require_known(reader, e.where, fmt::format("value of the knob '{}'", knob), label, labels);
      }
    }
  }
}

void complete_study(Reader& reader, const Node& node, void* object) {
  auto& study = *static_cast<Study*>(object);
  if (study.title.empty()) study.title = study.name;
  if (study.seed_keys.empty()) study.seed_keys = {"scene.seed"};
  const bool of_scene = study.experiment == Study::Experiment::scene;
  if (of_scene && study.scene.empty())
    reader.problem(node, "'scene' is missing: the scene that the knobs are turned on");
  if (study.knobs.empty() && !study.operator_knobs)
    reader.problem(node, "'knobs' is missing: what the study varies");
  if (study.errors.empty()) reader.problem(node, "'errors' is missing: what the study measures");
  check_references(reader, study);
}

}  // namespace

const scene::Table& study_table() {
  static const scene::Table table = [] {
    scene::Table study;
    study.doc = "A Pileus study: what accuracy costs in time.";
    study.keys = {
        scene::section("study", identity_table()),
        extends_key("study"),
        scene::choice("experiment", &Study::experiment, {"scene", "shape_integrators"},
                      "What is run: a scene, or ways to deform parcels in a given random strain."),
        scene::value("scene", &Study::scene, "1", "The base scene, relative to the study.")
            .otherwise("none"),
        settings_key("set", &Study::settings,
                     "Keys of the scene that all points change: time.end: 20 s."),
        scene::sections("knobs", &Study::knobs, knob_table()),
        scene::value("operator_knobs", &Study::operator_knobs, "1",
                     "Vary as well every parameter that an operator of the scene declares as "
                     "trading accuracy for time, along the ladder it declares."),
        scene::choice("combine", &Study::combine, {"product", "one_at_a_time"},
                      "All combinations of the knobs' values, or each knob alone with the others "
                      "where the scene has them."),
        settings_key("finest", &Study::finest,
                     "Keys of the run that errors are measured against, where they need one. "
                     "Without: every knob at its last value."),
        scene::value("repeats", &Study::repeats, "1",
                     "How often every point is run for its time; the median counts.")
            .at_least(1)
            .at_most(1000),
        seeds_key(),
        scene::value("seed_keys", &Study::seed_keys, "1", "Keys of the scene that take the seed.")
            .otherwise("[scene.seed]"),
        scene::value("threads", &Study::threads, "1", "Threads of every run.")
            .at_least(1)
            .at_most(1024),
        scene::choice("cost", &Study::cost, {"core_time", "wall_time", "parcel_steps"},
                      "What accuracy is paid in: processor or wall time of the time steps without "
                      "diagnostics and output (s), or parcels times steps."),
        scene::sections("errors", &Study::errors, norm_table()),
        scene::sections("published", &Study::published, published_table()),
        scene::sections("expect", &Study::expect, expect_table())};
    study.finish = complete_study;
    return study;
  }();
  return table;
}

std::string Study::scene_path() const {
  return (std::filesystem::path(path).parent_path() / scene).lexically_normal().string();
}

bool Study::needs_finest() const {
  return std::any_of(errors.begin(), errors.end(),
                     [](const ErrorNorm& norm) { return norm.needs_finest(); });
}

Study read_study(const std::string& path, scene::Problems& problems) {
  Study study;
  study.path = path;
  study.name = std::filesystem::path(path).stem().string();
  const Node root = scene::load_document(path, problems, study_kind);
  if (root.kind != Node::Kind::mapping) return study;
  scene::Scene unused;  // a study has no constants and no dimension of its own
  scene::Reader reader(unused, problems, study_table());
  reader.section(root, study_table(), &study);
  return study;
}

std::string study_schema() {
  const Study defaults;
  return scene::file_schema("Pileus study", study_table(), &defaults);
}

CostWords words_of(const Study& study) {
  if (study.experiment == Study::Experiment::shape_integrators) return {"time per shape", "ns"};
  switch (study.cost) {
    case Cost::wall_time:
      return {"wall time", "s"};
    case Cost::parcel_steps:
      return {"parcel-steps", "1"};
    default:
      return {"processor time", "s"};
  }
}

}  // namespace pileus::study

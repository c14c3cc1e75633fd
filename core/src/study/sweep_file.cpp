#include "study/sweep_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "base/units.hpp"
#include "scene/reader.hpp"
#include "scene/schema.hpp"
#include "study/file_keys.hpp"
#include "study/scene_settings.hpp"
#include "study/study_knobs.hpp"

namespace pileus::study {

using scene::Entry;
using scene::Node;
using scene::Reader;

namespace {

const scene::DocumentKind sweep_kind = {"sweep", "'scene'", "scene:, product:, seeds:"};

/// A key of a range that is read as it is written, unit and all.
scene::Key limit_key(const std::string& name, Node SampleRange::*member, const std::string& doc) {
  scene::Key key;
  key.name = name;
  key.type = scene::KeyType::custom;
  key.doc = doc;
  key.required = true;
  key.read = [member](Reader&, const Entry& entry, void* object) {
    static_cast<SampleRange*>(object)->*member = entry.value;
  };
  key.write = [](const void*) -> scene::Json { return nullptr; };
  key.schema = [] { return scene::Json{{"type", scene::Json::array({"number", "string"})}}; };
  return key;
}

std::optional<WrittenQuantity> quantity_of(Reader& reader, const Node& node, const char* name) {
  auto written = node.kind == Node::Kind::scalar ? split_quantity(node.text)
                                                 : std::optional<WrittenQuantity>();
  if (!written || !(written->unit.empty() || is_unit(written->unit))) {
    reader.problem(node, fmt::format("'{}' expects a number, with its unit where it has one; "
                                     "found {}",
                                     name, describe(node)));
    return std::nullopt;
  }
  return written;
}

/// Puts both limits into the unit of the lower one.
void complete_range(Reader& reader, const Node& node, void* object) {
  auto& range = *static_cast<SampleRange*>(object);
  range.where = node.where;
  if (range.name.empty()) range.name = last_word(range.key);
  if (node.find("low") == nullptr || node.find("high") == nullptr) return;
  const auto low = quantity_of(reader, range.low_text, "low");
  const auto high = quantity_of(reader, range.high_text, "high");
  if (!low || !high) return;
  range.low = low->number;
  range.high = high->number;
  range.unit = low->unit;
  if (low->unit.empty() != high->unit.empty())
    return reader.problem(range.high_text, "'low' and 'high' either both have a unit or neither");
  if (low->unit != high->unit) {
    const UnitConversion converted = convert_units(high->number, high->unit, low->unit);
    if (!converted.ok())
      return reader.problem(range.high_text, fmt::format("'high': {}", converted.problem));
    range.high = converted.value;
  }
  if (!(range.high > range.low))
    return reader.problem(range.high_text,
                          fmt::format("'high' has to be above 'low', {}", range.low_text.text));
  if (range.scale == SampleRange::Scale::log && !(range.low > 0))
    reader.problem(range.low_text, "a logarithmic scale needs a 'low' above 0");
  if (range.whole && (range.low != std::floor(range.low) || range.high != std::floor(range.high)))
    reader.problem(range.low_text, "with 'whole', 'low' and 'high' have to be whole numbers");
}

const scene::Table& range_table() {
  static const scene::Table table = {
      .path = "sample.ranges",
      .doc = "What is sampled: keys of the scene, each between two values.",
      .keys = {scene::value("name", &SampleRange::name, "1", "Name in tables, files and pictures.")
                   .otherwise("the last word of the key"),
               scene::value("key", &SampleRange::key, "1", "Dotted key of the scene.").must(),
               limit_key("low", &SampleRange::low_text, "Lowest value, with its unit."),
               limit_key("high", &SampleRange::high_text,
                         "Highest value, in any unit of its kind."),
               scene::choice("scale", &SampleRange::scale, {"linear", "log"},
                             "Whether values, or their logarithms, are spread evenly."),
               scene::value("whole", &SampleRange::whole, "1", "Whole numbers only.")},
      .other = {},
      .finish = complete_range,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const scene::Table& sample_table() {
  static const scene::Table table = {
      .path = "sample",
      .doc = "Members at points of a sample, the same on every machine.",
      .keys = {scene::choice("method", &SamplePlan::method, {"random", "latin_hypercube", "sobol"},
                             "Independent points, one point in each of 'count' strata of every "
                             "range, or the points of the Sobol sequence (best a power of two)."),
               scene::value("count", &SamplePlan::count, "1", "Number of points.")
                   .at_least(0)
                   .at_most(99999),
               scene::value("seed", &SamplePlan::seed, "1",
                            "Seed of the sample, which is not that of the scene. The Sobol "
                            "sequence is as published with 0 and shifted with any other.")
                   .at_least(0),
               scene::sections("ranges", &SamplePlan::ranges, range_table())},
      .other = {},
      .finish =
          [](Reader& reader, const Node& node, void* object) {
            const auto& sample = *static_cast<SamplePlan*>(object);
            if (node.kind != Node::Kind::mapping || node.entries.empty()) return;
            if (sample.count < 1) reader.problem(node, "'sample' needs a 'count' of points");
            if (sample.ranges.empty()) reader.problem(node, "'sample' needs 'ranges'");
            if (sample.ranges.size() > most_sample_dimensions)
              reader.problem(node, fmt::format("'sample' has {} ranges, more than {}",
                                               sample.ranges.size(), most_sample_dimensions));
          },
      .write_other = {},
      .amend_schema = {}};
  return table;
}

scene::Key list_key() {
  scene::Key key;
  key.name = "list";
  key.type = scene::KeyType::custom;
  key.doc =
      "Members one by one: a list of mappings from keys of the scene to values. A key that an "
      "entry leaves out stands as the scene has it.";
  key.default_doc = "none";
  key.read = [](Reader& reader, const Entry& entry, void* object) {
    if (entry.value.kind != Node::Kind::list || entry.value.items.empty())
      return reader.problem(entry.value, fmt::format("'list' is a list of mappings, found {}",
                                                     describe(entry.value)));
    for (const Node& item : entry.value.items) {
      ListedSettings& listed = static_cast<Sweep*>(object)->list.emplace_back();
      listed.where = item.where;
      read_settings(reader, "list", item, listed.settings);
    }
  };
  key.write = [](const void*) -> scene::Json { return nullptr; };
  key.schema = [] { return scene::Json{{"type", "array"}, {"items", {{"type", "object"}}}}; };
  return key;
}

/// A list of seeds, none of them twice: two members would be one run.
void read_listed_seeds(Reader& reader, const Node& node, std::vector<std::uint64_t>& seeds) {
  if (node.items.empty())
    return reader.problem(node,
                          "'seeds' needs at least one seed, or their number; found an empty "
                          "list");
  Node one = node;
  for (const Node& item : node.items) {
    one.items = {item};
    const std::size_t before = seeds.size();
    read_seeds(reader, one, seeds);
    if (seeds.size() > before &&
        std::find(seeds.begin(), seeds.end() - 1, seeds.back()) != seeds.end() - 1)
      reader.problem(item, fmt::format("the seed {} is listed twice", seeds.back()));
  }
}

/// A number of seeds, or the seeds themselves.
scene::Key sweep_seeds_key() {
  scene::Key key;
  key.name = "seeds";
  key.type = scene::KeyType::custom;
  key.doc =
      "Every combination is run once with each of these seeds: a list, or their number n for the "
      "seeds 1 to n.";
  key.default_doc = "the scene's own";
  key.read = [](Reader& reader, const Entry& entry, void* object) {
    auto& seeds = static_cast<Sweep*>(object)->seeds;
    if (entry.value.kind == Node::Kind::list) return read_listed_seeds(reader, entry.value, seeds);
    scene::Key number;
    number.name = "seeds";
    number.range.low = 1;
    number.range.high = 99999;
    std::int64_t count = 0;
    if (!reader.integer(entry.value, number, count)) return;
    for (std::int64_t seed = 1; seed <= count; ++seed)
      seeds.push_back(static_cast<std::uint64_t>(seed));
  };
  key.write = [](const void*) -> scene::Json { return nullptr; };
  key.schema = [] {
    scene::Json list = list_of_seeds();
    list["minItems"] = 1;
    list["uniqueItems"] = true;
    return scene::Json{
        {"anyOf", scene::Json::array({{{"type", "integer"}, {"minimum", 1}}, std::move(list)})}};
  };
  return key;
}

const scene::Table& identity_table() {
  static const scene::Table table =
      identity_of<Sweep>("sweep", "What the sweep is called and what it is for.",
                         "Name of its folder and pictures.", "What it is for, at length.");
  return table;
}

/// The name becomes that of a folder below results/sweeps and of files in it.
void check_name(Reader& reader, const Node& node, const Sweep& sweep) {
  const Entry* identity = node.find("sweep");
  const Entry* name = identity == nullptr ? nullptr : identity->value.find("name");
  const auto is_control = [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; };
  const bool fits = !sweep.name.empty() && sweep.name.front() != '.' &&
                    sweep.name.find('/') == std::string::npos &&
                    std::none_of(sweep.name.begin(), sweep.name.end(), is_control);
  if (fits) return;
  std::string shown = sweep.name;
  std::replace_if(shown.begin(), shown.end(), is_control, '?');
  reader.problem(name == nullptr ? node : name->value,
                 fmt::format("'{}' cannot be the name of a sweep, which is that of its folder: "
                             "'sweep.name' expects a word without '/' that does not begin with "
                             "'.'{}",
                             shown, name == nullptr ? "; by default it is the file's" : ""));
}

/// Options of sbatch that the batch script sets itself.
constexpr std::array<std::string_view, 6> own_options = {"job-name",      "array",  "ntasks",
                                                         "cpus-per-task", "output", "signal"};

/// Each becomes a line of the batch script; what would end up as a word of another kind, or undo
/// what the script relies on, is told here and not by Slurm.
void check_slurm(Reader& reader, const Node& node, const Sweep& sweep) {
  const Entry* entry = node.find("slurm");
  if (entry == nullptr) return;
  for (std::size_t i = 0; i < sweep.slurm.size(); ++i) {
    const std::string& option = sweep.slurm[i];
    const Node& where = i < entry->value.items.size() ? entry->value.items[i] : entry->value;
    const std::string name = option.substr(0, option.find_first_of("= "));
    if (!name.starts_with("--") || name.size() < 3) {
      reader.problem(where,
                     fmt::format("'slurm' expects options of sbatch in their long form, such "
                                 "as '--time=01:00:00'; found '{}'",
                                 option));
      continue;
    }
    for (const std::string_view own : own_options)  // sbatch completes shortened names
      if (own.starts_with(name.substr(2)))
        reader.problem(where, fmt::format("the batch script sets '--{}' itself; leave '{}' out of "
                                          "'slurm'",
                                          own, option));
  }
}

void complete_sweep(Reader& reader, const Node& node, void* object) {
  auto& sweep = *static_cast<Sweep*>(object);
  check_name(reader, node, sweep);
  check_slurm(reader, node, sweep);
  if (sweep.title.empty()) sweep.title = sweep.name;
  if (sweep.seed_keys.empty()) sweep.seed_keys = {"scene.seed"};
  for (const char* name : {"seeds", "seed_keys"})
    if (const Entry* entry = node.find(name)) sweep.seeds_where = entry->where;
  if (sweep.product.empty() && sweep.list.empty() && sweep.sample.count == 0 &&
      node.find("sample") == nullptr && sweep.seeds.empty() && node.find("seeds") == nullptr)
    reader.problem(node,
                   "the sweep has no members: give 'product', 'list', 'sample', 'seeds' or "
                   "several of them");
}

}  // namespace

std::string SampleRange::value_at(double place) const {
  double value = low + place * (high - low);
  if (scale == Scale::log)
    value = std::exp(std::log(low) + place * (std::log(high) - std::log(low)));
  if (whole)  // every whole number is met as often
    value = scale == Scale::log ? std::round(value)
                                : std::min(high, low + std::floor(place * (high - low + 1)));
  const std::string number = fmt::format("{:.10g}", value);
  return unit.empty() ? number : number + " " + unit;
}

const scene::Table& sweep_table() {
  static const scene::Table table = [] {
    scene::Table sweep;
    sweep.doc = "A Pileus sweep: one scene with many settings and seeds, run as an ensemble.";
    sweep.keys = {
        scene::section("sweep", identity_table()),
        extends_key("sweep"),
        scene::value("scene", &Sweep::scene, "1", "The scene, relative to the sweep.").must(),
        settings_key("set", &Sweep::settings,
                     "Keys of the scene that all members change: time.end: 20 s."),
        scene::sections("product", &Sweep::product, product_table()),
        list_key(),
        scene::section("sample", &Sweep::sample, sample_table()),
        sweep_seeds_key(),
        scene::value("seed_keys", &Sweep::seed_keys, "1", "Keys of the scene that take the seed.")
            .otherwise("[scene.seed]"),
        scene::value("threads", &Sweep::threads, "1", "Threads of every member.")
            .at_least(1)
            .at_most(1024),
        scene::value("pictures", &Sweep::pictures, "1",
                     "Series of which the spread over the members is drawn.")
            .otherwise("a few"),
        scene::value("slurm", &Sweep::slurm, "1",
                     "Further options of the batch script, in their long form: ['--time=01:00:00', "
                     "'--partition=small'].")
            .otherwise("none")};
    sweep.finish = complete_sweep;
    return sweep;
  }();
  return table;
}

std::string Sweep::scene_path() const {
  return (std::filesystem::path(path).parent_path() / scene).lexically_normal().string();
}

Sweep read_sweep(const std::string& path, scene::Problems& problems) {
  Sweep sweep;
  sweep.path = path;
  sweep.name = std::filesystem::path(path).stem().string();
  const Node root = scene::load_document(path, problems, sweep_kind);
  if (root.kind != Node::Kind::mapping) return sweep;
  scene::Scene unused;  // a sweep has no constants and no dimension of its own
  scene::Reader reader(unused, problems, sweep_table());
  reader.section(root, sweep_table(), &sweep);
  return sweep;
}

std::string sweep_schema() {
  const Sweep defaults;
  return scene::file_schema("Pileus sweep", sweep_table(), &defaults);
}

}  // namespace pileus::study

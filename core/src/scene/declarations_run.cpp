// The declared keys of what runs and what comes out: operators, coupling, effects, output, expect.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/nearest_word.hpp"
#include "scene/declarations.hpp"
#include "scene/reader.hpp"

namespace pileus::scene {
namespace {

const std::vector<std::string> effect_modes = {"off", "on", "watch"};

RawValue raw_value(Reader& reader, const Entry& entry) {
  RawValue raw;
  raw.where = entry.value.where;
  raw.key_where = entry.where;
  raw.text = entry.value.text;
  raw.is_list = entry.value.kind == Node::Kind::list;
  bool scalars = true;
  const auto texts = [&](const Node& list) {
    std::vector<std::string> items;
    for (const Node& item : list.items) {
      scalars = scalars && item.kind == Node::Kind::scalar;
      items.push_back(item.text);
    }
    return items;
  };
  raw.list = texts(entry.value);
  for (const Entry& column : entry.value.entries) {
    scalars = scalars && column.value.kind == Node::Kind::list;
    raw.columns.emplace_back(column.key, texts(column.value));
  }
  if (entry.value.kind == Node::Kind::mapping) scalars = scalars && !raw.columns.empty();
  if (!scalars)
    reader.problem(
        entry.value,
        fmt::format("the parameter '{}' expects a value, a list of values or a mapping of "
                    "such lists, found {}",
                    entry.key, describe(entry.value)));
  return raw;
}

bool read_parameter(Reader& reader, const Entry& entry, void* object) {
  static_cast<OperatorBlock*>(object)->parameters.emplace_back(entry.key, raw_value(reader, entry));
  return true;
}

void complete_operator(Reader& reader, const Node& node, void* object) {
  auto& block = *static_cast<OperatorBlock*>(object);
  block.where = node.where;
  if (block.name.empty()) block.name = operator_label(node);
  for (const OperatorBlock& other : reader.scene().operators)
    if (&other != &block && other.name == block.name && !block.name.empty())
      reader.problems().add(
          {node.where, fmt::format("two operators are called '{}'; give one a 'name'", block.name),
           1, other.where, "the other one is here"});
}

Json raw_to_json(const RawValue& raw) {
  if (!raw.columns.empty()) {
    Json columns = Json::object();
    for (const auto& [name, items] : raw.columns) columns[name] = items;
    return columns;
  }
  if (!raw.is_list) return raw.text;
  Json list = Json::array();
  for (const std::string& item : raw.list) list.push_back(item);
  return list;
}

int effect_mode(Reader& reader, const Node& node) {
  if (node.kind == Node::Kind::scalar && node.text == "watch") return 2;
  if (const auto state =
          node.kind == Node::Kind::scalar ? read_switch(node.text) : std::optional<bool>())
    return *state ? 1 : 0;
  reader.problem(node,
                 fmt::format("an effect is 'on', 'off' or 'watch', found {}", describe(node)));
  return -1;
}

/// One effect of a mapping: a word, or `mode` and `on_trip`.
void read_effect(Reader& reader, const Entry& entry, EffectRequests& effects) {
  const Node& node = entry.value;
  const Node* mode_node = &node;
  bool stop = false;
  if (node.kind == Node::Kind::mapping) {
    mode_node = nullptr;
    for (const Entry& key : node.entries) {
      Key words;
      words.name = key.key;
      words.choices = {"activate", "stop"};
      if (key.key == "mode")
        mode_node = &key.value;
      else if (key.key == "on_trip")
        stop = reader.choice(key.value, words) == 1;
      else
        reader.problem(key.value,
                       fmt::format("an effect has 'mode' and 'on_trip', found '{}'", key.key));
    }
  }
  if (mode_node == nullptr) {
    reader.problem(node, "the effect has no 'mode': on, off or watch");
    return;
  }
  const int mode = effect_mode(reader, *mode_node);
  if (mode < 0) return;
  if (node.find("on_trip") != nullptr && mode != 2)
    reader.problem(node, "'on_trip' has a meaning only with 'mode: watch'");
  effects.requests.push_back(
      {entry.key, static_cast<EffectRequests::Mode>(mode), entry.where, stop});
}

void read_effects(Reader& reader, const Entry& entry, void* object) {
  auto& effects = static_cast<Scene*>(object)->effects;
  const Node& node = entry.value;
  if (node.kind == Node::Kind::scalar && node.text == "auto") return;
  if (node.kind == Node::Kind::list) {
    effects.form = EffectRequests::Form::list;
    for (const Node& item : node.items) {
      std::string name;
      if (reader.text(item, "effects", name))
        effects.requests.push_back({name, EffectRequests::Mode::on, item.where, false});
    }
  } else if (node.kind == Node::Kind::mapping) {
    effects.form = EffectRequests::Form::map;
    for (const Entry& effect : node.entries) read_effect(reader, effect, effects);
  } else {
    reader.problem(node, fmt::format("'effects' is 'auto', a list of effects, or a mapping of each "
                                     "to on, off or watch; found {}",
                                     describe(node)));
  }
}

Json write_effects(const void* object) {
  const auto& effects = static_cast<const Scene*>(object)->effects;
  if (effects.form == EffectRequests::Form::automatic) return "auto";
  Json all = effects.form == EffectRequests::Form::list ? Json::array() : Json::object();
  for (const EffectRequests::Request& request : effects.requests) {
    if (effects.form == EffectRequests::Form::list)
      all.push_back(request.name);
    else if (request.stop_on_trip)
      all[request.name] = {{"mode", "watch"}, {"on_trip", "stop"}};
    else
      all[request.name] = effect_modes[static_cast<std::size_t>(request.mode)];
  }
  return all;
}

void check_expectation(Reader& reader, const Node& node, void* object) {
  auto& expectation = *static_cast<Expectation*>(object);
  expectation.where = node.where;
  if (!expectation.low && !expectation.high && node.find("between") == nullptr)
    reader.problems().add(node.where,
                          fmt::format("the expectation of '{}' has no bound; give 'at_least', "
                                      "'at_most' or 'between'",
                                      expectation.diagnostic));
  if (expectation.low && expectation.high && *expectation.low > *expectation.high)
    reader.problems().add(
        node.where,
        fmt::format("no value of '{}' is both at least {} and at most {}", expectation.diagnostic,
                    shortest(*expectation.low), shortest(*expectation.high)));
  if (expectation.statistic.empty()) expectation.statistic = "final";
}

Key between_key() {
  Key key;
  key.name = "between";
  key.type = KeyType::custom;
  key.doc = "Both bounds [lowest, highest], in the diagnostic's SI unit.";
  key.default_doc = "none";
  key.read = [](Reader& reader, const Entry& entry, void* object) {
    auto& expectation = *static_cast<Expectation*>(object);
    Key bound;
    bound.name = "between";
    if (entry.value.items.size() != 2) {
      reader.problem(entry.value, fmt::format("'between' expects [lowest, highest], found {}",
                                              describe(entry.value)));
      return;
    }
    double low = 0, high = 0;
    if (!reader.number(entry.value.items[0], bound, low) ||
        !reader.number(entry.value.items[1], bound, high))
      return;
    if (expectation.low || expectation.high)
      reader.problem(entry.value, "give either 'between' or 'at_least' and 'at_most'");
    expectation.low = low;
    expectation.high = high;
  };
  key.write = [](const void*) -> Json { return nullptr; };  // written as at_least and at_most
  key.schema = [] {
    return Json{{"type", "array"},
                {"minItems", 2},
                {"maxItems", 2},
                {"items", {{"type", Json::array({"number", "string"})}}}};
  };
  return key;
}

void complete_output(Reader& reader, const Node&, void* object) {
  auto& output = *static_cast<OutputControl*>(object);
  const Scene& scene = reader.scene();
  const auto fill = [&](OutputStream& stream, double parts) {
    if (stream.every < 0) stream.every = scene.time.end / parts;
  };
  fill(output.fields, 20);
  fill(output.parcels, 2);
  fill(output.profiles, 100);
  fill(output.series, 200);
  if (output.directory.empty()) output.directory = "results/" + scene.name;
}

Table stream_table(const char* name, const char* doc, const char* every) {
  return {.path = std::string("output.") + name,
          .doc = doc,
          .keys = {value("every", &OutputStream::every, "s",
                         "Simulated time between records; 0 s switches the stream off.")
                       .at_least(0)
                       .otherwise(every),
                   value("variables", &OutputStream::variables, "1", "Names of what is written.")
                       .otherwise("the stream's own list")},
          .other = {},
          .finish = {},
          .write_other = {},
          .amend_schema = {}};
}

const Table& spectra_table() {
  static const Table table = {
      .path = "output.spectra",
      .doc = "Size spectra of droplets over the radius of their water, in spectra.nc.",
      .keys =
          {value("every", &SpectraControl::every, "s",
                 "Simulated time between records; 0 s switches the stream off.")
               .at_least(0),
           value("smallest", &SpectraControl::smallest, "m", "Lower edge of the first bin.")
               .above(0),
           value("largest", &SpectraControl::largest, "m", "Upper edge of the last bin.").above(0),
           value("bins", &SpectraControl::bins, "1", "Number of bins of equal width in ln r.")
               .at_least(1)
               .at_most(10000),
           value("gridded", &SpectraControl::gridded, "1",
                 "In every cell of the mesh, besides the mean over the domain.")},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& droplets_table() {
  static const Table table = {
      .path = "output.droplets",
      .doc = "The items of the parcels (droplets) themselves, in droplets.nc.",
      .keys = {value("every", &DropletOutput::every, "s",
                     "Simulated time between records; 0 s switches the stream off.")
                   .at_least(0),
               value("fraction", &DropletOutput::fraction, "1",
                     "Share of the items that is written, drawn by chance.")
                   .above(0)
                   .at_most(1)},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& checkpoint_table() {
  static const Table table = {
      .path = "output.checkpoint",
      .doc = "Checkpoints from which a run can be resumed.",
      .keys = {value("wall_interval", &OutputControl::checkpoint_every_wall, "s",
                     "Wall-clock time between checkpoints; 0 s for none.")
                   .at_least(0),
               value("steps", &OutputControl::checkpoint_every_steps, "1",
                     "Time steps between checkpoints; 0 for none.")
                   .at_least(0),
               value("kept", &OutputControl::checkpoints_kept, "1",
                     "How many of the latest checkpoints are kept.")
                   .at_least(1)
                   .at_most(1000)},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

}  // namespace

const Table& operator_table() {
  static const Table table = {
      .path = "operators",
      .doc = "Physics beyond the flow, by plugins, in the order in which it is coupled.",
      .keys = {value("use", &OperatorBlock::use, "1",
                     "Identifier of the operator (org.example.kessler) or path of its "
                     "library.")
                   .must(),
               value("name", &OperatorBlock::name, "1", "Label in the plan, order and ledger.")
                   .otherwise("the last word of 'use'")},
      .other = read_parameter,
      .finish = complete_operator,
      .write_other =
          [](const void* object) {
            Json all = Json::object();
            for (const auto& [name, raw] : static_cast<const OperatorBlock*>(object)->parameters)
              all[name] = raw_to_json(raw);
            return all;
          },
      .amend_schema = [](Json& schema) { schema.erase("additionalProperties"); }};
  return table;
}

const Table& coupling_table() {
  static const Table table = {
      .path = "coupling",
      .doc = "How operators and transport are composed over a time step.",
      .keys = {choice("scheme", &Coupling::scheme, {"lie", "strang"},
                      "One pass (first order), or symmetric half steps (second order)."),
               value("order", &Coupling::order, "1",
                     "Names of the operators, the outermost (stiffest) first.")
                   .otherwise("as listed in 'operators'"),
               value("skip_inactive", &Coupling::skip_inactive, "1",
                     "Leave parcels out that an operator declares it would not change; results "
                     "are the same bits either way."),
               value("audit", &Coupling::audit, "1",
                     "Share of the blocks left out that is called after all on a copy; a parcel "
                     "that would have changed ends the run.")
                   .at_least(0)
                   .at_most(1)},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

/// The forms of one effect in a mapping.
Json effect_forms() {
  const Json word{{"enum", Json::array({true, false, "on", "off", "watch"})}};
  const Json detailed{
      {"type", "object"},
      {"additionalProperties", false},
      {"required", Json::array({"mode"})},
      {"properties", {{"mode", word}, {"on_trip", {{"enum", Json::array({"activate", "stop"})}}}}}};
  return Json::array({word, detailed});
}

Key effects_key() {
  Key key;
  key.name = "effects";
  key.type = KeyType::custom;
  key.doc =
      "Which effects are simulated: 'auto' leaves all to the planner, a list switches exactly "
      "these "
      "on, a mapping states on, off or watch for those named. A watched effect is left out until "
      "something calls for it; {mode: watch, on_trip: stop} ends the run then instead of switching "
      "the effect on.";
  key.default_doc = "auto";
  key.read = read_effects;
  key.write = write_effects;
  key.schema = [] {
    return Json{
        {"anyOf",
         Json::array(
             {Json{{"const", "auto"}}, Json{{"type", "array"}, {"items", {{"type", "string"}}}},
              Json{{"type", "object"}, {"additionalProperties", {{"anyOf", effect_forms()}}}}})}};
  };
  return key;
}

const Table& output_table() {
  static const Table fields =
      stream_table("fields", "Gridded fields.", "a twentieth of the simulated time");
  static const Table parcels = stream_table("parcels", "All parcels.", "half the simulated time");
  static const Table profiles = [] {
    Table table = stream_table("profiles", "Horizontal means by height.",
                               "a hundredth of the simulated time");
    table.keys.push_back(value("sample", &OutputStream::sample, "s",
                               "Simulated time between samples; a record is the mean of the "
                               "samples since the one before.")
                             .above(0)
                             .otherwise("a record is of one moment"));
    return table;
  }();
  static const Table series = stream_table("series", "Domain integrals and extrema over time.",
                                           "a two-hundredth of the simulated time");
  static const Table table = {
      .path = "output",
      .doc = "What is written, and where.",
      .keys = {value("directory", &OutputControl::directory, "1", "Folder of the results.")
                   .otherwise("results/<name of the scene>"),
               section("fields", &OutputControl::fields, fields),
               section("parcels", &OutputControl::parcels, parcels),
               section("profiles", &OutputControl::profiles, profiles),
               section("series", &OutputControl::series, series),
               section("spectra", &OutputControl::spectra, spectra_table()),
               section("droplets", &OutputControl::droplets, droplets_table()),
               value("compress", &OutputControl::compress, "1", "Compress the files, losslessly."),
               value("mantissa_bits", &OutputControl::mantissa_bits, "1",
                     "Bits kept of every number written to fields and parcels; 0 keeps all.")
                   .at_least(0)
                   .at_most(52),
               section("checkpoint", checkpoint_table())},
      .other = {},
      .finish = complete_output,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& expectation_table() {
  static const Table table = {
      .path = "expect",
      .doc =
          "Bounds that a right run keeps; 'pileus check' judges them. An item 'inherited' stands "
          "for "
          "those of the scene that this one extends.",
      .keys =
          {value("diagnostic", &Expectation::diagnostic, "1", "Name of a diagnostic.").must(),
           [] {
             Key key = value(
                 "statistic", &Expectation::statistic, "1",
                 "Which number of its series: the value at the start or end, an "
                 "extremum or mean over the run, final over initial minus one, max over initial "
                 "minus one, the rate at which the logarithm of its magnitude grows (s-1, least "
                 "squares), the mean of |1 - value/mean|, the first value that is a number, or the "
                 "time of the first above zero.");
             key.type = KeyType::custom;
             key.choices = {"initial",
                            "final",
                            "min",
                            "max",
                            "mean",
                            "relative_change",
                            "relative_rise",
                            "growth_rate",
                            "mean_deviation",
                            "first_value",
                            "first_time_above"};
             key.default_doc = "final";
             key.read = [choices = key.choices](Reader& reader, const Entry& entry, void* object) {
               Key words;
               words.name = "statistic";
               words.choices = choices;
               const int index = reader.choice(entry.value, words);
               if (index >= 0)
                 static_cast<Expectation*>(object)->statistic =
                     choices[static_cast<std::size_t>(index)];
             };
             key.write = [](const void* object) -> Json {
               return static_cast<const Expectation*>(object)->statistic;
             };
             key.schema = [choices = key.choices] { return Json{{"enum", choices}}; };
             return key;
           }(),
           value("at", &Expectation::at, "s", "Take the value at this simulated time.").at_least(0),
           value("from", &Expectation::from, "s",
                 "Statistics over the run begin at this simulated time.")
               .at_least(0),
           value("at_least", &Expectation::low, "1", "Lowest value allowed, in SI."),
           value("at_most", &Expectation::high, "1", "Highest value allowed, in SI."),
           between_key(),
           value("source", &Expectation::source, "1", "Where the bound comes from.")},
      .other = {},
      .finish = check_expectation,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

}  // namespace pileus::scene

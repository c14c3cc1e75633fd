// The declared keys of numerics and of what is measured: exact solutions and histograms.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "scene/declarations.hpp"
#include "scene/reader.hpp"

namespace pileus::scene {
namespace {

/// What variables of a NetCDF file may be called, in part or as a whole.
bool is_part_of_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

/// Refuses a name that no variable of series.nc could have; what is left out is reported elsewhere.
void check_name(Reader& reader, const Node& node, const std::string& name) {
  const Entry* entry = node.find("name");
  if (entry == nullptr || entry->value.kind != Node::Kind::scalar) return;
  if (!is_part_of_name(name) || (name.front() >= '0' && name.front() <= '9'))
    reader.problem(entry->value, fmt::format("'{}' cannot name a diagnostic: names are letters, "
                                             "digits and underscores, with no digit first",
                                             name));
}

void check_exact(Reader& reader, const Node& node, void* object) {
  static_cast<ExactSolution*>(object)->where = node.where;
  const Entry* formula = node.find("formula");
  if (formula != nullptr && formula->value.kind == Node::Kind::scalar)
    reader.formula(formula->value, {"x", "y", "z", "t"});
}

/// Tables of published numbers lie beside the scene that cites them.
void check_reference(Reader& reader, const Node& node, void* object) {
  auto& reference = *static_cast<HistogramControl::Reference*>(object);
  reference.where = node.where;
  if (const Entry* label = node.find("label"); label != nullptr &&
                                               label->value.kind == Node::Kind::scalar &&
                                               !is_part_of_name(reference.label))
    reader.problem(
        label->value,
        fmt::format("'{}' cannot be part of a diagnostic's name, <name>_distance_<label>: "
                    "labels are letters, digits and underscores",
                    reference.label));
  const Entry* file = node.find("file");
  if (file == nullptr || file->value.kind != Node::Kind::scalar) return;
  const std::string& beside =
      file->value.where.line > 0 ? file->value.where.file : reader.scene().path;
  const std::filesystem::path full = std::filesystem::path(beside).parent_path() / reference.path;
  if (!std::filesystem::exists(full))
    reader.problem(file->value,
                   fmt::format("there is no file '{}' (looked for '{}')", reference.path,
                               std::filesystem::absolute(full).lexically_normal().string()));
  reference.path = std::filesystem::absolute(full).lexically_normal().string();
}

void check_histogram(Reader& reader, const Node& node, void* object) {
  auto& histogram = *static_cast<HistogramControl*>(object);
  histogram.where = node.where;
  check_name(reader, node, histogram.name);
  if (!(histogram.low < histogram.high))
    reader.problems().add(node.where,
                          fmt::format("a histogram needs 'low' below 'high', found {} "
                                      "and {}",
                                      shortest(histogram.low), shortest(histogram.high)));
}

const Table& exact_table() {
  static const Table table = {
      .path = "diagnostics.exact",
      .doc =
          "Known solutions; each gives <variable>_rms_error and, with a frequency, "
          "<variable>_phase_error and <variable>_frequency_error.",
      .keys = {value("variable", &ExactSolution::variable, "1", "Gridded field that is compared.")
                   .must(),
               value("formula", &ExactSolution::formula, "1",
                     "The exact field in SI, of x, y, z (m), t (s) and constants.")
                   .must(),
               value("frequency", &ExactSolution::frequency, "s-1",
                     "Angular frequency of a wave whose phase is measured; 0 for none.")
                   .at_least(0)},
      .other = {},
      .finish = check_exact,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

void check_mode(Reader& reader, const Node& node, void* object) {
  auto& mode = *static_cast<ModeControl*>(object);
  mode.where = node.where;
  check_name(reader, node, mode.name);
  for (const char* key : {"cosine", "sine"}) {
    const Entry* formula = node.find(key);
    if (formula != nullptr && formula->value.kind == Node::Kind::scalar)
      reader.formula(formula->value, {"x", "y", "z"});
  }
}

const Table& mode_table() {
  static const Table table = {
      .path = "diagnostics.modes",
      .doc =
          "Parts of gridded fields with a given shape; each gives <name>_amplitude and, with a "
          "sine, <name>_phase.",
      .keys =
          {value("name", &ModeControl::name, "1", "Prefix of the diagnostics.").must(),
           value("variable", &ModeControl::variable, "1", "Gridded field that is measured.").must(),
           value("cosine", &ModeControl::cosine, "1",
                 "Shape of the mode: a formula of x, y, z (m) and constants.")
               .must(),
           value("sine", &ModeControl::sine, "1",
                 "Shape of the mode a quarter wavelength further; without it the mode stands.")},
      .other = {},
      .finish = check_mode,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

void check_front(Reader& reader, const Node& node, void* object) {
  auto& front = *static_cast<FrontControl*>(object);
  front.where = node.where;
  check_name(reader, node, front.name);
}

const Table& front_table() {
  static const Table table = {
      .path = "diagnostics.fronts",
      .doc =
          "Largest distances in x from the domain's centre at which a gridded field is beyond a "
          "threshold; each gives <name>_position.",
      .keys = {value("name", &FrontControl::name, "1", "Prefix of the diagnostic.").must(),
               value("variable", &FrontControl::variable, "1", "Gridded field that is measured.")
                   .must(),
               value("threshold", &FrontControl::threshold, "1",
                     "Threshold, in the field's SI "
                     "unit.")
                   .must(),
               choice("side", &FrontControl::side, {"below", "above"},
                      "On which side of the threshold the field is within the front."),
               value("height", &FrontControl::height, "m", "Height at which the front is sought.")
                   .otherwise("the ground")},
      .other = {},
      .finish = check_front,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& mirror_table() {
  static const Table table = {
      .path = "diagnostics.mirrors",
      .doc =
          "Gridded fields that should be their own mirror image at the domain's centre in x; each "
          "gives <variable>_asymmetry, the largest difference over the largest magnitude.",
      .keys = {value("variable", &MirrorControl::variable, "1", "Gridded field that is measured.")
                   .must(),
               choice("parity", &MirrorControl::parity, {"even", "odd"},
                      "Whether the mirror image equals the field or its negative.")},
      .other = {},
      .finish = [](Reader&, const Node& node,
                   void* object) { static_cast<MirrorControl*>(object)->where = node.where; },
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& reference_table() {
  using Reference = HistogramControl::Reference;
  static const Table table = {
      .path = "diagnostics.histograms.references",
      .doc = "Published histograms to compare with; each gives <name>_distance_<label>.",
      .keys = {value("label", &Reference::label, "1", "Name of the published result.").must(),
               value("file", &Reference::path, "1",
                     "CSV file with a header row and one row per bin, relative to the scene.")
                   .must(),
               value("column", &Reference::column, "1", "Column with the densities.").must()},
      .other = {},
      .finish = check_reference,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& histogram_table() {
  static const Table table = {
      .path = "diagnostics.histograms",
      .doc =
          "Volume-weighted histograms of parcel quantities; each gives <name>_mode and "
          "<name>_highest.",
      .keys =
          {value("name", &HistogramControl::name, "1", "Prefix of the diagnostics.").must(),
           value("variable", &HistogramControl::variable, "1", "Quantity of the parcels.").must(),
           value("unit", &HistogramControl::unit, "1",
                 "The quantity is divided by this number before binning.")
               .above(0),
           value("low", &HistogramControl::low, "1", "Lower edge of the first bin."),
           value("high", &HistogramControl::high, "1", "Upper edge of the last bin."),
           value("bins", &HistogramControl::bins, "1", "Number of equal bins.")
               .at_least(1)
               .at_most(100000),
           sections("references", &HistogramControl::references, reference_table())},
      .other = {},
      .finish = check_histogram,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& variance_budget_table() {
  static const Table table = {
      .path = "diagnostics.variance_budgets",
      .doc =
          "Carried quantities whose variance over the domain is accounted for; each gives "
          "<variable>_variance, <variable>_variance_lost_to_operators and "
          "<variable>_variance_lost_to_mergers.",
      .keys = {value("variable", &VarianceBudgetControl::variable, "1", "Quantity of the parcels.")
                   .must()},
      .other = {},
      .finish =
          [](Reader&, const Node& node, void* object) {
            static_cast<VarianceBudgetControl*>(object)->where = node.where;
          },
      .write_other = {},
      .amend_schema = {}};
  return table;
}

/// A slab value's name is the whole name of a variable.
void check_slab_name(Reader& reader, const Node& node, const SlabValueControl& control) {
  check_name(reader, node, control.name);
  if (control.name == "time")
    reader.problem(node.find("name")->value,
                   "'time' cannot name a diagnostic: it is what series.nc calls its times");
  for (const SlabValueControl& other : reader.scene().diagnostics.slabs.values)
    if (&other != &control && other.name == control.name && !control.name.empty())
      reader.problems().add({node.where,
                             fmt::format("two slab values are called '{}'", control.name), 1,
                             other.where, "the other one is here"});
}

void check_slab_value(Reader& reader, const Node& node, void* object) {
  auto& control = *static_cast<SlabValueControl*>(object);
  control.where = node.where;
  check_slab_name(reader, node, control);
  const bool at_height = control.measure == SlabValueControl::Measure::value;
  if (at_height && node.find("height") == nullptr)
    reader.problems().add(
        node.where, fmt::format("the slab value '{}' needs a 'height'; the other measures than "
                                "'value' take 'between: [lower, upper]'",
                                control.name));
  if (at_height != (node.find("between") == nullptr) && node.find("between") != nullptr)
    reader.problems().add(node.where,
                          fmt::format("the slab value '{}' is taken at one height: it has no "
                                      "'between'",
                                      control.name));
  if (!at_height && node.find("height") != nullptr)
    reader.problems().add(node.where, fmt::format("the slab value '{}' is of a range of heights: "
                                                  "give 'between: [lower, upper]'",
                                                  control.name));
  if (control.between.size() == 2 && !(control.between[0] < control.between[1]))
    reader.problems().add(node.where,
                          fmt::format("the slab value '{}' needs the lower height first, found {} "
                                      "and {}",
                                      control.name, with_units(control.between[0], "m"),
                                      with_units(control.between[1], "m")));
}

const Table& slab_value_table() {
  static const Table table = {
      .path = "diagnostics.slabs.values",
      .doc = "Numbers of profiles over height, each a diagnostic of its own name.",
      .keys = {value("name", &SlabValueControl::name, "1", "Name of the diagnostic.").must(),
               value("variable", &SlabValueControl::variable, "1",
                     "Statistic of slabs, such as core_mass_flux or z_velocity_variance.")
                   .must(),
               choice("measure", &SlabValueControl::measure,
                      {"value", "mean", "min", "max", "height_of_min", "height_of_max", "slope",
                       "nonlinearity", "logarithmic_slope"},
                      "The value at one height, linear between levels; a mean, an extremum or its "
                      "height over levels; the slope of the least-squares line, or the largest "
                      "deviation from that line over the line's largest magnitude; the slope of "
                      "the line over the logarithm of the height above the bottom."),
               value("height", &SlabValueControl::height, "m",
                     "Height at which the value is taken.")
                   .otherwise("none"),
               value("between", &SlabValueControl::between, "m",
                     "Heights [lower, upper] between which levels count.")
                   .counted(Count::two)
                   .otherwise("the whole column"),
               value(
                   "averaged_from", &SlabValueControl::averaged_from, "s",
                   "Take the mean profile over all records of the series from this simulated time "
                   "on; before it there is no value.")
                   .at_least(0)
                   .otherwise("the profile of the moment")},
      .other = {},
      .finish = check_slab_value,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& slabs_table() {
  static const Table table = {
      .path = "diagnostics.slabs",
      .doc =
          "Statistics of horizontal slabs: means, variances, fluxes, clouds and cores over height "
          "in profiles.nc, inversion and entrainment over time. The section switches them on.",
      .keys = {sections("values", &SlabControl::values, slab_value_table())},
      .other = {},
      .finish = [](Reader&, const Node&,
                   void* object) { static_cast<SlabControl*>(object)->wanted = true; },
      .write_other = [](const void* object) -> Json {
        const auto& control = *static_cast<const SlabControl*>(object);
        // Even a section without keys says something.
        if (!control.wanted || !control.values.empty()) return Json::object();
        return Json{{"values", Json::array()}};
      },
      .amend_schema = {}};
  return table;
}

}  // namespace

const Table& water_path_table() {
  static const Table table = {
      .path = "diagnostics.water_path",
      .doc =
          "The mass of liquid water over an area of the ground: density times mass fraction, "
          "summed "
          "over the parcels between two heights.",
      .keys = {value("density", &WaterPathControl::density, "kg m-3",
                     "Density of the air, a function of z alone."),
               value("bottom", &WaterPathControl::bottom, "m", "Height above which parcels count.")
                   .otherwise("the domain's bottom"),
               value("top", &WaterPathControl::top, "m", "Height below which parcels count.")
                   .otherwise("the domain's top")},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& numerics_table() {
  static const Table table = {
      .path = "numerics",
      .doc = "Choices of the numerical method; each trades accuracy for time.",
      .keys = {choice("shape_integrator", &NumericsControl::shape_integrator,
                      {"exponential", "runge_kutta"},
                      "How the parcels' ellipsoids deform: by the matrix exponential, exact in "
                      "volume, or by the Runge-Kutta scheme."),
               choice("vertical_derivative", &NumericsControl::vertical_derivative,
                      {"compact", "centred"}, "Difference scheme of vertical derivatives."),
               value("spectral_filter", &NumericsControl::spectral_filter, "1",
                     "Hou-Li filter on the gridded vorticity."),
               value("window_compensation", &NumericsControl::window_compensation, "1",
                     "How much of what deposit and interpolation take from resolved scales of "
                     "vorticity and buoyancy the flow makes good: 0 nothing, 1 all to fourth "
                     "order. Parcels' own values are not touched.")
                   .at_least(0)
                   .at_most(1)},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& diagnostics_table() {
  static const Table table = {
      .path = "diagnostics",
      .doc = "What is measured beyond the standard diagnostics, and definitions those leave open.",
      .keys = {value("cloud_threshold", &DiagnosticControl::cloud_threshold, "1",
                     "Cloud liquid water mass fraction above which air counts as cloud.")
                   .at_least(0),
               section("water_path", &DiagnosticControl::water_path, water_path_table()),
               sections("exact", &DiagnosticControl::exact, exact_table()),
               sections("modes", &DiagnosticControl::modes, mode_table()),
               sections("fronts", &DiagnosticControl::fronts, front_table()),
               sections("mirrors", &DiagnosticControl::mirrors, mirror_table()),
               sections("histograms", &DiagnosticControl::histograms, histogram_table()),
               sections("variance_budgets", &DiagnosticControl::variance_budgets,
                        variance_budget_table()),
               section("slabs", &DiagnosticControl::slabs, slabs_table())},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

}  // namespace pileus::scene

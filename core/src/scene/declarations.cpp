// The declared keys of the sections that are plain numbers, words and switches.
#include "scene/declarations.hpp"

#include <fmt/format.h>

#include <cmath>

#include "scene/field_sampler.hpp"
#include "scene/reader.hpp"

namespace pileus::scene {
namespace {

void check_parcels(Reader& reader, const Node& node, void* object) {
  const auto& parcels = *static_cast<ParcelControl*>(object);
  const Entry* where = node.find("where");
  if (where != nullptr && parcels.where.form == FieldDescription::Form::constant &&
      !(parcels.where.constant > 0))
    reader.problem(
        where->value,
        "'where' is positive nowhere, so there would be no parcel; it is a formula of x, "
        "y, z that is positive where parcels start");
  const int dimension = reader.scene().domain.dimension;
  const int side = static_cast<int>(std::lround(std::pow(parcels.per_cell, 1.0 / dimension)));
  const auto power = [&](int m) { return dimension == 3 ? m * m * m : m * m; };
  const Entry* entry = node.find("per_cell");
  if (entry == nullptr || power(side) == parcels.per_cell) return;
  const int below = power(side) < parcels.per_cell ? side : side - 1;
  reader.problem(entry->value,
                 fmt::format("'per_cell' = {} is not a {} number; parcels start on a regular "
                             "lattice, so take {} or {}",
                             parcels.per_cell, dimension == 3 ? "cube" : "square",
                             power(std::max(1, below)), power(below + 1)));
}

void complete_domain(Reader&, const Node&, void* object) {
  auto& domain = *static_cast<Domain*>(object);
  if (domain.lower.empty()) domain.lower.assign(static_cast<std::size_t>(domain.dimension), 0.0);
}

/// What `coriolis`, `latitude` and the N² shortcut come to.
void complete_background(Reader& reader, const Node& node, void* object) {
  auto& background = *static_cast<Background*>(object);
  const Entry* coriolis = node.find("coriolis");
  const Entry* latitude = node.find("latitude");
  if (coriolis != nullptr && latitude != nullptr) {
    reader.problems().add({latitude->where, "give either 'coriolis' or 'latitude', not both", 8,
                           coriolis->where, "'coriolis' is given here"});
  } else if (background.latitude) {
    const double twice = 2 * background.rotation_rate;
    background.coriolis = {
        0, background.horizontal_coriolis ? twice * std::cos(*background.latitude) : 0,
        twice * std::sin(*background.latitude)};
  }
  if (latitude == nullptr)
    for (const char* key : {"rotation_rate", "horizontal_coriolis"})
      if (const Entry* entry = node.find(key))
        reader.problem(entry->value, fmt::format("'{}' has a meaning only with 'latitude'", key));
  background.latitude.reset();
  background.rotation_rate = Background{}.rotation_rate;
  background.horizontal_coriolis = false;

  const Entry* frequency = node.find("squared_buoyancy_frequency");
  const Entry* reference = node.find("reference_buoyancy");
  if (frequency != nullptr && reference != nullptr) {
    reader.problems().add({frequency->where,
                           "give either 'squared_buoyancy_frequency' or 'reference_buoyancy', not "
                           "both",
                           26, reference->where, "'reference_buoyancy' is given here"});
  } else if (background.squared_buoyancy_frequency) {
    FieldDescription& field = background.reference_buoyancy;
    field.form = FieldDescription::Form::formula;
    field.formula = shortest(*background.squared_buoyancy_frequency) + "*z";
    field.where = frequency->value.where;
  }
  background.reference_buoyancy.units = "m s-2";
  if (reference != nullptr && reader.problems().empty() &&
      !FieldSampler(background.reference_buoyancy, reader.scene()).height_alone())
    reader.problem(reference->value,
                   "the reference buoyancy is a function of z alone: a value, a formula of z or a "
                   "profile, without noise");
  background.squared_buoyancy_frequency.reset();
}

/// The planetary vorticity: one number is its vertical component.
Key coriolis_key() {
  Key key;
  key.name = "coriolis";
  key.type = KeyType::custom;
  key.units = "s-1";
  key.doc =
      "Planetary vorticity f (twice the rotation vector): one value is its vertical component, a "
      "list of three is [f_x, f_y, f_z].";
  key.default_doc = "0 s-1";
  key.read = [](Reader& reader, const Entry& entry, void* object) {
    auto& f = static_cast<Background*>(object)->coriolis;
    Key number;
    number.name = "coriolis";
    number.units = "s-1";
    const Node& node = entry.value;
    if (node.kind != Node::Kind::list) {
      reader.number(node, number, f[2]);
    } else if (node.items.size() != 3) {
      reader.problem(node, fmt::format("'coriolis' is one value (the vertical component) or a list "
                                       "of three, found a list of {}",
                                       node.items.size()));
    } else {
      for (std::size_t i = 0; i < 3; ++i) reader.number(node.items[i], number, f[i]);
    }
  };
  key.write = [](const void* object) {
    Json list = Json::array();
    for (const double f : static_cast<const Background*>(object)->coriolis)
      list.push_back(with_units(f, "s-1"));
    return list;
  };
  key.schema = [] {
    return Json{
        {"anyOf", Json::array({Json{{"type", Json::array({"number", "string"})}},
                               Json{{"type", "array"},
                                    {"minItems", 3},
                                    {"maxItems", 3},
                                    {"items", {{"type", Json::array({"number", "string"})}}}}})}};
  };
  return key;
}

void complete_energy(Reader& reader, const Node& node, void* object) {
  auto& energy = *static_cast<EnergyControl*>(object);
  energy.where = node.where;
  using Form = EnergyControl::Form;
  const Entry* formula = node.find("formula");
  if (energy.form == Form::linear && !(energy.squared_buoyancy_frequency > 0))
    reader.problems().add(node.where,
                          "available potential energy of the form 'linear' needs a "
                          "'squared_buoyancy_frequency' greater than 0");
  if (energy.form == Form::formula && formula == nullptr)
    reader.problems().add(node.where,
                          "available potential energy of the form 'formula' needs 'formula', a "
                          "function of b and z");
  if (formula != nullptr && formula->value.kind == Node::Kind::scalar) {
    if (energy.form != Form::formula)
      reader.problem(formula->value, "'formula' is used only with 'form: formula'");
    reader.formula(formula->value, {"b", "z"});
  }
}

}  // namespace

const Table& domain_table() {
  static const Table table = {
      .path = "domain",
      .doc = "The box: periodic in the horizontal, impermeable walls at bottom and top.",
      .keys = {value("extent", &Domain::extent, "m",
                     "Size of the box: [x, y, z], or [x, z] for a two-dimensional scene; one value "
                     "for a cube.")
                   .must()
                   .above(0)
                   .counted(Count::dimension),
               value("lower", &Domain::lower, "m", "Corner with the smallest coordinates.")
                   .counted(Count::dimension)
                   .otherwise("0 m in every direction"),
               value("cells", &Domain::cells, "1", "Number of mesh cells in each direction.")
                   .must()
                   .at_least(1)
                   .at_most(65536)
                   .counted(Count::dimension)},
      .other = {},
      .finish = complete_domain,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& step_table() {
  static const Table table = {
      .path = "time.step",
      .doc = "What limits the time step.",
      .keys = {value("alpha", &TimeControl::alpha, "1",
                     "The step is at most alpha over the largest of sqrt(|grad buoyancy|) and the "
                     "planetary vorticity.")
                   .above(0)
                   .at_most(10),
               value("strain_alpha", &TimeControl::strain_alpha, "1",
                     "The step is at most strain_alpha over the largest strain rate; default: "
                     "twice alpha, or alpha with numerics.shape_integrator: runge_kutta.")
                   .above(0)
                   .at_most(20),
               value("courant", &TimeControl::courant, "1",
                     "The step is at most courant times the mesh spacing over the speed.")
                   .above(0)
                   .at_most(10),
               value("largest", &TimeControl::largest, "s", "Upper bound on the step; 0 for none.")
                   .at_least(0),
               value("fixed", &TimeControl::fixed, "s",
                     "A constant step that replaces every limit.")
                   .above(0)},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& time_table() {
  static const Table table = {
      .path = "time",
      .doc = "How long, and by which scheme.",
      .keys = {value("end", &TimeControl::end, "s", "Simulated time at which the run ends.")
                   .must()
                   .at_least(0),
               choice("scheme", &TimeControl::scheme, {"rk3", "rk4"},
                      "Low-storage Runge-Kutta scheme: third order with three stages or fourth "
                      "order with five."),
               section("step", step_table()),
               value("max_steps", &TimeControl::max_steps, "1",
                     "Largest number of time steps; 0 for no limit.")
                   .at_least(0)},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& background_table() {
  static const Table table = {
      .path = "background",
      .doc = "Rotation, and the reference state from which buoyancy is measured.",
      .keys = {coriolis_key(),
               value("latitude", &Background::latitude, "rad",
                     "Latitude, for example 45 degrees; sets coriolis from the planet's rotation.")
                   .at_least(-1.5707963267948968)
                   .at_most(1.5707963267948968),
               value("rotation_rate", &Background::rotation_rate, "s-1",
                     "Angular velocity of the planet, with latitude.")
                   .at_least(0)
                   .only_read(),
               value("horizontal_coriolis", &Background::horizontal_coriolis, "1",
                     "With latitude: keep the horizontal component 2 Omega cos(latitude) of the "
                     "planetary vorticity too.")
                   .only_read(),
               value("squared_buoyancy_frequency", &Background::squared_buoyancy_frequency, "s-2",
                     "N squared of a linear reference buoyancy N^2 z.")
                   .at_least(0),
               value("reference_buoyancy", &Background::reference_buoyancy, "m s-2",
                     "Reference buoyancy as a function of z; only deviations from it drive the "
                     "flow, which is exact and keeps a resting atmosphere at rest.")},
      .other = {},
      .finish = complete_background,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& parcels_table() {
  static const Table table = {
      .path = "parcels",
      .doc = "How many parcels there are, and when they split and merge.",
      .keys = {value("per_cell", &ParcelControl::per_cell, "1",
                     "Parcels per cell at the start, on a regular lattice: m^3, or m^2 in two "
                     "dimensions.")
                   .at_least(1)
                   .at_most(4096)
                   .otherwise("8; 9 in two dimensions"),
               value("offset", &ParcelControl::offset, "1",
                     "Place of the lattice in the cells: distance of its first point from the "
                     "cell's lower corner in lattice spacings. 0 and 1 put parcels on walls, faces "
                     "and corners.")
                   .at_least(0)
                   .at_most(1),
               value("where", &ParcelControl::where, "1",
                     "Parcels start only where this formula of x, y, z is positive; there they are "
                     "larger, so that together they have the domain's volume.")
                   .otherwise("everywhere"),
               value("jitter", &ParcelControl::jitter, "1",
                     "Random displacement at the start, as a fraction of the lattice spacing.")
                   .at_least(0)
                   .at_most(1),
               value("seed", &ParcelControl::seed, "1", "Seed of the jitter.").at_least(0),
               value("max_aspect_ratio", &ParcelControl::max_aspect_ratio, "1",
                     "A parcel splits when its longest half-axis exceeds this many times the "
                     "shortest.")
                   .above(1)
                   .at_most(1000),
               value("min_volume_ratio", &ParcelControl::min_volume_ratio, "1",
                     "A parcel is merged when smaller than the cell volume over this.")
                   .above(0)
                   .otherwise("20; 40 in two dimensions"),
               value("max_volume_ratio", &ParcelControl::max_volume_ratio, "1",
                     "Two dimensions only: a parcel splits when larger than the cell area over "
                     "this.")
                   .above(0),
               value("merging", &ParcelControl::merging, "1", "Whether small parcels are merged."),
               value("splitting", &ParcelControl::splitting, "1",
                     "Whether stretched and large parcels split."),
               value("correction_iterations", &ParcelControl::correction_iterations, "1",
                     "Volume corrections (Laplace, then gradient) per step; 0 for none.")
                   .at_least(0)
                   .at_most(100),
               value("gradient_prefactor", &ParcelControl::gradient_prefactor, "1",
                     "Prefactor of the gradient correction.")
                   .at_least(0),
               value("max_compression", &ParcelControl::max_compression, "1",
                     "Largest compression the gradient correction may ask for.")
                   .at_least(0)},
      .other = {},
      .finish = check_parcels,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& boundaries_table() {
  static const Table table = {
      .path = "boundaries",
      .doc = "What is imposed on the walls beside zero vertical velocity.",
      .keys = {choice("vertical_vorticity", &Boundaries::vertical_vorticity,
                      {"automatic", "zero", "free"},
                      "Vertical vorticity on the walls: kept zero, left free, or kept zero if and "
                      "only if it starts at zero.")},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& energy_table() {
  static const Table table = {
      .path = "energy",
      .doc = "How available potential energy is measured.",
      .keys = {choice("form", &EnergyControl::form, {"none", "linear", "formula", "sorted"},
                      "linear: (b - N^2 z)^2 / (2 N^2); formula: a function of b and z; sorted: "
                      "against the initial state sorted by buoyancy."),
               value("squared_buoyancy_frequency", &EnergyControl::squared_buoyancy_frequency,
                     "s-2", "N squared of the form 'linear', which needs it.")
                   .at_least(0),
               value("formula", &EnergyControl::formula, "1",
                     "Energy density in m2 s-2 as a function of b (m s-2) and z (m).")},
      .other = {},
      .finish = complete_energy,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

}  // namespace pileus::scene

// A validated scene: what the YAML file said, in SI units, every default filled in.
#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pileus::scene {

/// Where a value stands in a file; line and column count from 1, 0 when unknown (command line).
struct Location {
  std::string file;
  int line = 0;
  int column = 0;
};

/// Piecewise-linear profile over height, constant beyond its ends.
struct Profile {
  std::vector<double> height;  // m, ascending
  std::vector<double> value;   // SI
};

/// Uniform noise, one draw per grid cell (all parcels of a cell get the same value), inside a
/// layer.
struct Noise {
  double amplitude = 0;  // SI; uniform in ±amplitude
  // m; infinite: everywhere
  double bottom = -std::numeric_limits<double>::infinity();
  double top = std::numeric_limits<double>::infinity();
  std::uint64_t seed = 0;
};

/// An initial field as the scene states it. Exactly one form is set (`form`).
struct FieldDescription {
  enum class Form { constant, formula, profile, file };
  Form form = Form::constant;
  double constant = 0;  // SI
  std::string formula;  // muParser text in x, y, z (m) and the scene's constants
  Profile profile;
  std::string path, variable;  // gridded data in HDF5/netCDF, trilinear between its nodes
  std::string file_units;      // of the gridded data; empty: as its attribute says, else `units`
  std::optional<Noise> noise;
  std::string units;  // expected UDUNITS of the value
  Location where;
};

/// A formula with a name that other formulas may use: a function of x, y, z, evaluated where they
/// are.
struct NamedFormula {
  std::string name;
  std::string text;
  Location where;
};

struct Domain {
  int dimension = 3;           // 2 when `extent` has two entries (x, z)
  std::vector<double> lower;   // m
  std::vector<double> extent;  // m
  std::vector<int> cells;
};

enum class RungeKutta { order3_stages3, order4_stages5 };

struct TimeControl {
  double end = 0;  // s
  RungeKutta scheme = RungeKutta::order4_stages5;
  double alpha = 0.25;  // dt ≤ alpha/max(sqrt|grad b|, f)
  std::optional<double>
      strain_alpha;             // dt ≤ strain_alpha/strain rate; there once the scene is read
  double courant = 1.0;         // dt ≤ courant·Δ/|u|
  double largest = 0;           // s; cap on dt, 0: none given (the end time caps it)
  std::optional<double> fixed;  // s; replaces every limit
  std::uint64_t max_steps = 0;  // 0: no limit
};

/// Uniform background rotation and the reference state buoyancy is measured from.
struct Background {
  std::vector<double> coriolis = {0, 0, 0};  // planetary vorticity f in x, y, z, s-1
  FieldDescription reference_buoyancy;       // function of z only, m s-2; default constant 0
  // Ways to state the above; empty once the scene is read.
  std::optional<double> latitude;    // rad
  double rotation_rate = 7.2921e-5;  // s-1, of the planet, with `latitude`
  bool horizontal_coriolis = false;  // with `latitude`: keep f_y = 2 Ω cos(latitude) too
  std::optional<double> squared_buoyancy_frequency;  // s-2; reference N² z
};

struct ParcelControl {
  int per_cell = 8;     // m^D on a regular sub-lattice
  double offset = 0.5;  // of the first lattice point from the cell's corner, in lattice spacings
  double jitter = 0;    // fraction of the sub-lattice spacing
  std::uint64_t seed = 0;
  /// Parcels start only where it is positive; a uniform field: everywhere.
  FieldDescription where;
  double max_aspect_ratio = 4;     // split at lambda ≥ this (2D: >)
  double min_volume_ratio = 20;    // merge below V_cell/ratio (2D default 40)
  double max_volume_ratio = 2.89;  // 2D only: split above V_cell/ratio
  int correction_iterations = 2;
  double gradient_prefactor = 1.8;
  double max_compression = 0.5;
  bool merging = true, splitting = true;
};

/// Where the velocity comes from: the vorticity of the parcels, or formulas.
struct FlowControl {
  struct Component {
    std::string formula = "0";  // m s-1; of x, y, z (m), t (s), constants and named formulas
    Location where;
  };
  bool prescribed = false;
  Component x, y, z;
  Location where;  // of the prescription
};

struct Boundaries {
  enum class WallVorticity { automatic, zero, free };
  /// Vertical vorticity at the walls: kept zero, free, or zero if and only if it starts at zero.
  WallVorticity vertical_vorticity = WallVorticity::automatic;
};

struct Initial {
  bool velocity_given = false;                      // else vorticity
  std::vector<FieldDescription> vorticity;          // 3 components, or 1 in 2D; empty: zero
  std::vector<FieldDescription> velocity;           // one per direction
  std::vector<double> mean_wind;                    // m s-1, horizontal components
  std::map<std::string, FieldDescription> scalars;  // quantity name → field
};

/// A raw value of an operator's block, checked later against the plugin's declarations.
struct RawValue {
  std::string text;  // as written
  bool is_list = false;
  std::vector<std::string> list;
  Location where;      // of the value
  Location key_where;  // of the key
  /// A mapping of lists, as a function is written: {height: […], value: […]}.
  std::vector<std::pair<std::string, std::vector<std::string>>> columns = {};
};

struct OperatorBlock {
  std::string use;                                           // operator id or path to a library
  std::string name;                                          // label in plan, ledger and order
  std::vector<std::pair<std::string, RawValue>> parameters;  // everything but use and name
  Location where;
};

struct Coupling {
  enum class Scheme { lie, strang };
  Scheme scheme = Scheme::lie;
  std::vector<std::string> order;  // operator names, outermost first; empty: as listed
  bool skip_inactive = true;       // false: operators are called for every parcel
  double audit = 0;                // share of skipped blocks that is called after all, to compare
};

/// Initial state quantities in which the domain's potential energy is measured.
struct EnergyControl {
  enum class Form { none, linear, formula, sorted };
  Form form = Form::none;
  double squared_buoyancy_frequency = 0;  // s-2, for linear: a = (b − N²z)²/(2N²)
  std::string formula;                    // of b and z, for formula; m2 s-2
  Location where;
};

/// What the scene says about its effects; the planner turns it into verdicts.
struct EffectRequests {
  /// automatic: all left to the planner; list: exactly these are on, the rest is off; map: these as
  /// stated, the rest left to the planner.
  enum class Form { automatic, list, map };
  enum class Mode { off, on, watch };
  struct Request {
    std::string name;
    Mode mode = Mode::on;
    Location where;
    bool stop_on_trip = false;  // watched: end the run instead of switching the effect on
  };
  Form form = Form::automatic;
  std::vector<Request> requests;
};

struct OutputStream {
  double every = -1;                   // s; 0: off (−1 only while reading: take the default)
  std::vector<std::string> variables;  // empty: the stream's default list
  std::optional<double> sample;        // s, of profiles: records are means over such samples
};

/// Size spectra of the droplets, on bins of equal width in ln r.
struct SpectraControl {
  double every = 0;                        // s; 0: off
  double smallest = 1e-7, largest = 5e-3;  // radii at the outermost edges, m
  int bins = 60;
  bool gridded = true;  // in every cell besides over the domain
};

/// The droplets themselves.
struct DropletOutput {
  double every = 0;     // s; 0: off
  double fraction = 1;  // of the items, drawn by chance
};

struct OutputControl {
  std::string directory;  // default results/<scene>
  OutputStream fields, parcels, profiles, series;
  SpectraControl spectra;
  DropletOutput droplets;
  bool compress = true;
  int mantissa_bits = 0;                     // 0: exact
  double checkpoint_every_wall = 600;        // s of wall time
  std::uint64_t checkpoint_every_steps = 0;  // 0: off
  int checkpoints_kept = 2;
};

/// Choices of the numerical method; each trades accuracy for time.
struct NumericsControl {
  enum class ShapeIntegrator { exponential, runge_kutta };
  enum class VerticalDerivative { compact, centred };
  ShapeIntegrator shape_integrator = ShapeIntegrator::exponential;
  VerticalDerivative vertical_derivative = VerticalDerivative::compact;
  bool spectral_filter = true;  // Hou–Li filter on the gridded vorticity
  /// How much of what deposit and interpolation take from resolved scales the flow makes good:
  /// 0 nothing, 1 all to fourth order.
  double window_compensation = 1;
};

/// A known solution that a gridded field is compared with. Gives the diagnostics
/// `<variable>_rms_error` (r.m.s. difference over r.m.s. of the exact field, 1) and, with a
/// frequency, `<variable>_phase_error` (rad) and `<variable>_frequency_error` (1, relative).
struct ExactSolution {
  std::string variable;  // gridded field, e.g. upward_component_of_vorticity as written to files
  std::string formula;   // of x, y, z, t and the scene's constants
  double frequency = 0;  // s-1; 0: no phase is measured
  Location where;
};

/// Volume-weighted histogram of a parcel quantity over equal bins, with published ones to compare.
/// Gives `<name>_mode`, `<name>_highest` (upper edge of the last non-empty bin) and
/// `<name>_distance_<label>` (r.m.s. difference of densities over the bins above the first).
struct HistogramControl {
  struct Reference {
    std::string label, path, column;  // of a CSV file with a header row, one row per bin
    Location where;
  };
  std::string name, variable;
  double unit = 1;  // the quantity is divided by this before binning
  double low = 0, high = 1;
  int bins = 50;
  std::vector<Reference> references;
  Location where;
};

/// Part of a gridded field with a given shape. Gives `<name>_amplitude` and, with a sine,
/// `<name>_phase` (rad).
struct ModeControl {
  std::string name, variable;
  std::string cosine, sine;  // of x, y, z and the scene's constants; sine may be empty
  Location where;
};

/// How far in x from the domain's centre a gridded field is beyond a threshold at one height.
/// Gives `<name>_position` (m).
struct FrontControl {
  enum class Side { below, above };
  std::string name, variable;
  double threshold = 0;  // in the field's SI unit
  Side side = Side::below;
  std::optional<double> height;  // m; the ground when not given
  Location where;
};

/// A gridded field against its mirror image in x. Gives `<variable>_asymmetry` (1).
struct MirrorControl {
  enum class Parity { even, odd };
  std::string variable;
  Parity parity = Parity::even;
  Location where;
};

/// A carried quantity whose variance is accounted for. Gives `<variable>_variance`,
/// `<variable>_variance_lost_to_operators` and `<variable>_variance_lost_to_mergers`.
struct VarianceBudgetControl {
  std::string variable;
  Location where;
};

/// What the mass of water over an area of the ground is summed over.
struct WaterPathControl {
  WaterPathControl() {
    density.constant = 1;
    density.units = "kg m-3";
  }
  FieldDescription density;           // function of z only
  std::optional<double> bottom, top;  // m; the domain's without
};

/// A number of a profile of slab statistics, as a diagnostic of its own: `name`.
struct SlabValueControl {
  enum class Measure {
    value,
    mean,
    min,
    max,
    height_of_min,
    height_of_max,
    slope,
    nonlinearity,
    logarithmic_slope
  };
  std::string name, variable;
  Measure measure = Measure::value;
  std::optional<double> height;         // m, for value
  std::vector<double> between;          // m, two heights; empty: the whole column
  std::optional<double> averaged_from;  // s; the mean over the series' records since then
  Location where;
};

/// Statistics of horizontal slabs; none are taken where the scene does not have the section.
struct SlabControl {
  bool wanted = false;
  std::vector<SlabValueControl> values;
};

struct DiagnosticControl {
  double cloud_threshold = 1e-6;  // 1; liquid water mass fraction from which air counts as cloudy
  WaterPathControl water_path;
  std::vector<ExactSolution> exact;
  std::vector<ModeControl> modes;
  std::vector<FrontControl> fronts;
  std::vector<MirrorControl> mirrors;
  std::vector<HistogramControl> histograms;
  std::vector<VarianceBudgetControl> variance_budgets;
  SlabControl slabs;
};

struct Expectation {
  std::string diagnostic;      // name in summary.json:diagnostics
  std::string statistic;       // initial final min max mean relative_change …
  std::optional<double> at;    // s; the series value at this time instead of the end
  std::optional<double> from;  // s; statistics begin at this time instead of the start
  std::optional<double> low, high;
  std::string source;  // where the bound comes from
  Location where;
};

struct Scene {
  std::string name, title, description;
  std::string path;                         // of the YAML file
  std::map<std::string, double> constants;  // SI, for formulas
  std::vector<NamedFormula> formulas;       // in order; each may use those before it
  Domain domain;
  TimeControl time;
  Background background;
  ParcelControl parcels;
  Boundaries boundaries;
  FlowControl flow;
  Initial initial;
  std::vector<OperatorBlock> operators;
  Coupling coupling;
  EffectRequests effects;
  EnergyControl energy;
  NumericsControl numerics;
  DiagnosticControl diagnostics;
  OutputControl output;
  std::vector<Expectation> expect;
  std::uint64_t seed = 0;
  std::string resolved_yaml;  // the scene with all defaults, for provenance
};

}  // namespace pileus::scene

#include "model/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "coupling/quantity_plan.hpp"

namespace pileus::model {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr const char* liquid_name = "mass_fraction_of_cloud_liquid_water_in_air";
constexpr const char* rain_name = "mass_fraction_of_rain_in_air";
constexpr const char* total_water_name = "total_water_mass_fraction";
constexpr const char* water_budget = "water";

struct StateSums {
  double volume = 0, buoyancy = 0, potential = 0, enstrophy = 0;
  std::array<double, 3> vorticity{};
  double low = infinity, high = -infinity, largest_vorticity2 = 0;
  StateSums& operator+=(const StateSums& o) {
    volume += o.volume;
    buoyancy += o.buoyancy;
    potential += o.potential;
    enstrophy += o.enstrophy;
    for (std::size_t c = 0; c < 3; ++c) vorticity[c] += o.vorticity[c];
    low = std::min(low, o.low);
    high = std::max(high, o.high);
    largest_vorticity2 = std::max(largest_vorticity2, o.largest_vorticity2);
    return *this;
  }
};

struct ScalarSums {
  double sum = 0, low = infinity, high = -infinity;
};

struct VelocitySums {
  double energy = 0, speed2 = 0, up = -infinity, down = infinity;
};

struct CloudSums {
  double liquid = 0, high = 0;
  double cloudy = 0, cloudy_liquid = 0, cloudy_water = 0;  // over cloudy parcels
  double liquid_squared = 0, water_squared = 0;
  CloudSums& operator+=(const CloudSums& o) {
    liquid += o.liquid;
    high = std::max(high, o.high);
    cloudy += o.cloudy;
    cloudy_liquid += o.cloudy_liquid;
    cloudy_water += o.cloudy_water;
    liquid_squared += o.liquid_squared;
    water_squared += o.water_squared;
    return *this;
  }
};

/// Standard deviation from sums weighted by volume; zero where rounding has made it negative.
double deviation(double volume, double sum, double squares) {
  if (!(volume > 0)) return 0.0;
  const double mean = sum / volume;
  return std::sqrt(std::max(0.0, squares / volume - mean * mean));
}

}  // namespace

int Diagnostics::add(std::string name, std::string units, std::string long_name, bool conserved) {
  list_.push_back({std::move(name), std::move(units), std::move(long_name), conserved});
  return static_cast<int>(list_.size()) - 1;
}

int Diagnostics::index(const std::string& name) const {
  for (std::size_t i = 0; i < list_.size(); ++i)
    if (list_[i].name == name) return static_cast<int>(i);
  return -1;
}

Diagnostics::Diagnostics(const scene::Scene& scene, const Simulation& simulation,
                         const coupling::SurfaceFields& surface,
                         const std::vector<std::string>& changed,
                         const std::vector<std::string>& budgets, const SlabStatistics* slabs)
    : potential_energy_(scene),
      soundness_(simulation, changed),
      item_measures_(simulation.store().items()),
      surface_(surface),
      cloud_threshold_(scene.diagnostics.cloud_threshold) {
  const parcels::Store& store = simulation.store();
  const bool three = simulation.dimension() == 3;
  kinetic_ = add("kinetic_energy", "m2 s-2", "mean kinetic energy per mass, of the parcels");
  grid_kinetic_ = add("grid_kinetic_energy", "m2 s-2", "mean kinetic energy per mass, of the mesh");
  potential_ = add("potential_energy", "m2 s-2", "mean of -b (z - z_bottom)");
  available_ = add("available_potential_energy", "m2 s-2", "mean available potential energy");
  total_ = add("total_energy", "m2 s-2", "kinetic and available potential energy", true);
  mechanical_ = add("mechanical_energy", "m2 s-2", "kinetic and potential energy", true);
  enstrophy_ = add("enstrophy", "s-2", "mean of half the squared vorticity");
  volume_ = add("volume", three ? "m3" : "m2", "sum of the parcels' volumes", true);
  mean_buoyancy_ = add("mean_buoyancy", "m s-2", "mean buoyancy", true);
  min_buoyancy_ = add("min_buoyancy", "m s-2", "smallest buoyancy of a parcel");
  max_buoyancy_ = add("max_buoyancy", "m s-2", "largest buoyancy of a parcel");
  max_speed_ = add("max_speed", "m s-1", "largest speed of a parcel");
  max_vertical_velocity_ = add("max_vertical_velocity", "m s-1", "strongest updraught");
  min_vertical_velocity_ = add("min_vertical_velocity", "m s-1", "strongest downdraught");
  max_vorticity_ = add("max_vorticity", "s-1", "largest vorticity magnitude of a parcel");
  volume_error_rms_ = add("volume_error_rms", "1", "r.m.s. error of the gridded volume fraction");
  volume_error_max_ = add("volume_error_max", "1", "largest error of the gridded volume fraction");
  parcels_ = add("parcels", "1", "number of parcels");
  for (const auto& [name, units, text] : Soundness::outputs())
    soundness_entries_.push_back(add(name, units, text));
  for (int d = 0; d < simulation.dimension() - 1; ++d)
    mean_wind_.push_back(add(d == 0 ? "mean_wind_x" : "mean_wind_y", "m s-1", "domain-mean wind"));
  for (int c = 0; c < store.vorticity_components(); ++c)
    mean_vorticity_.push_back(
        add(three ? std::string("mean_") + "xyz"[c] + "_vorticity" : "mean_vorticity", "s-1",
            "domain-mean vorticity"));
  add_scalars(store);
  add_water(scene, simulation);
  for (const std::string& budget : budgets)
    budget_entries_.push_back(
        add(budget + "_budget_defect", "1",
            "change of the budget that no operator has booked as a source, relative to it"));
  for (const scene::ExactSolution& exact : scene.diagnostics.exact) {
    exact_.emplace_back(exact, scene, simulation);
    auto& entries = exact_entries_.emplace_back();
    for (const auto& [name, units, text] : exact_.back().outputs())
      entries.push_back(add(name, units, text));
  }
  add_gridded_measures(scene, simulation);
  for (const auto& [name, units, text] : simulation.variance_budget().outputs())
    variance_entries_.push_back(add(name, units, text));
  for (const scene::HistogramControl& control : scene.diagnostics.histograms) {
    histograms_.emplace_back(control, simulation);
    auto& entries = histogram_entries_.emplace_back();
    for (const auto& [name, units, text] : histograms_.back().outputs())
      entries.push_back(add(name, units, text));
  }
  if (slabs != nullptr) {
    slab_series_.emplace(scene, simulation, surface, *slabs);
    slab_series_->refuse_taken([this](const std::string& name) { return index(name) >= 0; });
    add_slab_series();
  }
  values_.assign(list_.size(), 0.0);
}

void Diagnostics::add_slab_series() {
  for (const auto& [name, units, text] : slab_series_->outputs()) {
    if (index(name) >= 0)
      throw Error(
          ExitCode::usage,
          fmt::format("diagnostics.slabs: its '{}' is also the name of another diagnostic of "
                      "this run; leave out the section or the other one.",
                      name));
    slab_entries_.push_back(add(name, units, text));
  }
}

void Diagnostics::add_scalars(const parcels::Store& store) {
  bool holds_water = false;
  for (std::size_t s = 0; s < store.scalars().size(); ++s) {
    const parcels::Scalar& scalar = store.scalars()[s];
    const bool derived = scalar.nature == parcels::Nature::derived;
    // Buoyancy has measures of its own, and so has liquid water that follows from the others.
    if (scalar.name == "buoyancy" || scalar.name == coupling::previous_height_name ||
        (derived && scalar.name == liquid_name))
      continue;
    ScalarEntries entries{static_cast<int>(s), 0, 0, 0, false};
    const bool conserved = scalar.nature == parcels::Nature::intensive;
    entries.mean = add("mean_" + scalar.name, scalar.units, "domain mean", conserved);
    entries.low = add("min_" + scalar.name, scalar.units, "smallest value of a parcel");
    entries.high = add("max_" + scalar.name, scalar.units, "largest value of a parcel");
    entries.water = !derived && scalar.budget == water_budget;
    holds_water = holds_water || entries.water;
    scalars_.push_back(entries);
  }
  for (const auto& [name, units, text] : item_measures_.outputs())
    item_entries_.push_back(add(name, units, text));
  for (const parcels::ItemColumn& column : store.items().declaration().columns)
    holds_water = holds_water || column.budget == water_budget;
  if (holds_water) total_water_ = add("total_water", "1", "mean total water", true);
  for (const coupling::SurfaceQuantity& quantity : surface_.list())
    surface_entries_.push_back(
        {add("mean_" + quantity.name, quantity.units, "mean over the ground"),
         add("max_" + quantity.name, quantity.units, "largest value of a column of cells")});
}

void Diagnostics::add_water(const scene::Scene& scene, const Simulation& simulation) {
  const parcels::Store& store = simulation.store();
  liquid_scalar_ = store.find_scalar(liquid_name);
  water_scalar_ = store.find_scalar(total_water_name);
  if (liquid_scalar_ >= 0) {
    mean_liquid_ = add("mean_liquid_water", "1", "mean cloud liquid water");
    max_liquid_ = add("max_liquid_water", "1", "largest cloud liquid water of a parcel");
    cloud_fraction_ = add("cloud_fraction", "1", "volume fraction of cloudy air");
    cloud_mean_liquid_ = add("cloud_mean_liquid_water", "1", "mean liquid water of cloudy air");
    liquid_path_ = add("atmosphere_mass_content_of_cloud_liquid_water", "kg m-2",
                       "mean mass of cloud liquid water over an area of the ground");
    cloud_liquid_deviation_ = add("cloud_liquid_water_deviation", "1",
                                  "standard deviation of the liquid water of cloudy air");
  }
  if (liquid_scalar_ >= 0 && water_scalar_ >= 0) {
    cloud_mean_water_ = add("cloud_mean_total_water", "1", "mean total water of cloudy air");
    cloud_water_deviation_ = add("cloud_total_water_deviation", "1",
                                 "standard deviation of the total water of cloudy air");
  }
  rain_scalar_ = store.find_scalar(rain_name);
  if (rain_scalar_ >= 0)
    rain_path_ = add("atmosphere_mass_content_of_liquid_precipitation", "kg m-2",
                     "mean mass of rain over an area of the ground");
  if (liquid_scalar_ >= 0 || rain_scalar_ >= 0) water_path_.emplace(scene, simulation);
}

void Diagnostics::add_gridded_measures(const scene::Scene& scene, const Simulation& simulation) {
  const scene::DiagnosticControl& control = scene.diagnostics;
  if (control.modes.empty() && control.fronts.empty() && control.mirrors.empty()) return;
  field_ = nodes_of(simulation);
  for (const scene::ModeControl& mode : control.modes) {
    modes_.push_back({Mode(mode, scene, field_), {}});
    for (const auto& [name, units, text] : modes_.back().mode.outputs())
      modes_.back().entries.push_back(add(name, units, text));
  }
  for (const scene::FrontControl& front : control.fronts)
    fronts_.emplace_back(front, add(front.name + "_position", "m",
                                    "largest distance in x from the centre of the domain"));
  for (const scene::MirrorControl& mirror : control.mirrors)
    mirrors_.emplace_back(mirror, add(mirror.variable + "_asymmetry", "1",
                                      "largest difference from the mirror image, relative"));
}

void Diagnostics::observe_gridded_measures(Simulation& simulation) {
  for (const ModeEntries& m : modes_) {
    simulation.grid_field(m.mode.variable(), field_.values);
    const std::vector<double> found = m.mode.measure(field_);
    for (std::size_t k = 0; k < found.size(); ++k) set(m.entries[k], found[k]);
  }
  for (const auto& [front, entry] : fronts_) {
    simulation.grid_field(front.variable, field_.values);
    set(entry, front_position(field_, front));
  }
  for (const auto& [mirror, entry] : mirrors_) {
    simulation.grid_field(mirror.variable, field_.values);
    set(entry, asymmetry(field_, mirror.parity == scene::MirrorControl::Parity::odd));
  }
}

void Diagnostics::observe_state(Simulation& simulation) {
  observe_parcels(simulation);
  observe_scalars(simulation);
  observe_cloud(simulation);
  observe_surface();
  const std::vector<double> soundness = soundness_.measure(simulation);
  for (std::size_t k = 0; k < soundness.size(); ++k) set(soundness_entries_[k], soundness[k]);
  set(grid_kinetic_, simulation.grid_kinetic_energy());
  const parcels::VolumeError error = simulation.volume_error();
  set(volume_error_rms_, error.rms);
  set(volume_error_max_, error.largest);
  set(parcels_, static_cast<double>(simulation.store().size()));
  for (std::size_t d = 0; d < mean_wind_.size(); ++d)
    set(mean_wind_[d], simulation.mean_wind().velocity[d]);
  set(available_, potential_energy_.available(simulation));
  for (std::size_t i = 0; i < exact_.size(); ++i) {
    const std::vector<double> found = exact_[i].compare(simulation);
    for (std::size_t k = 0; k < found.size(); ++k) set(exact_entries_[i][k], found[k]);
  }
  observe_gridded_measures(simulation);
  const std::vector<double> variance = simulation.variance_budget().measure(simulation.store());
  for (std::size_t k = 0; k < variance.size(); ++k) set(variance_entries_[k], variance[k]);
  for (std::size_t i = 0; i < histograms_.size(); ++i) {
    const std::vector<double> found = histograms_[i].measure(simulation);
    for (std::size_t k = 0; k < found.size(); ++k) set(histogram_entries_[i][k], found[k]);
  }
}

void Diagnostics::observe_slabs(const Simulation& simulation) {
  const std::vector<double> found = slab_series_->observe(simulation);
  for (std::size_t k = 0; k < found.size(); ++k) set(slab_entries_[k], found[k]);
}

void Diagnostics::observe_budgets(const std::vector<output::BudgetSummary>& budgets) {
  for (std::size_t i = 0; i < budgets.size() && i < budget_entries_.size(); ++i) {
    const double size = std::max(std::abs(budgets[i].initial), std::abs(budgets[i].final));
    set(budget_entries_[i], size > 0 ? budgets[i].defect / size : budgets[i].defect);
  }
}

void Diagnostics::observe_parcels(Simulation& simulation) {
  const parcels::Store& store = simulation.store();
  const double* volume = store.volume();
  const double* b = simulation.buoyancy();
  const double* z = store.position(simulation.dimension() - 1);
  const double bottom = simulation.bottom();
  const int components = store.vorticity_components();
  const StateSums sums = ordered_reduce(
      store.size(), StateSums{},
      [&](std::size_t begin, std::size_t end) {
        StateSums s;
        for (std::size_t p = begin; p < end; ++p) {
          const double v = volume[p];
          s.volume += v;
          s.buoyancy += v * b[p];
          s.potential -= v * b[p] * (z[p] - bottom);
          s.low = std::min(s.low, b[p]);
          s.high = std::max(s.high, b[p]);
          double square = 0;
          for (int c = 0; c < components; ++c) {
            const double omega = store.vorticity(c)[p];
            s.vorticity[static_cast<std::size_t>(c)] += v * omega;
            square += omega * omega;
          }
          s.enstrophy += 0.5 * v * square;
          s.largest_vorticity2 = std::max(s.largest_vorticity2, square);
        }
        return s;
      },
      [](StateSums a, const StateSums& o) { return a += o; });
  const double inverse = 1.0 / simulation.domain_volume();
  set(volume_, sums.volume);
  set(mean_buoyancy_, sums.buoyancy * inverse);
  set(potential_, sums.potential * inverse);
  set(enstrophy_, sums.enstrophy * inverse);
  set(min_buoyancy_, sums.low);
  set(max_buoyancy_, sums.high);
  set(max_vorticity_, std::sqrt(sums.largest_vorticity2));
  for (std::size_t c = 0; c < mean_vorticity_.size(); ++c)
    set(mean_vorticity_[c], sums.vorticity[c] * inverse);
}

void Diagnostics::observe_scalars(const Simulation& simulation) {
  const parcels::Store& store = simulation.store();
  const double* volume = store.volume();
  double total_water = 0;
  for (const ScalarEntries& entry : scalars_) {
    const double* value = store.scalar(entry.scalar);
    const bool per_volume = store.scalars()[static_cast<std::size_t>(entry.scalar)].nature !=
                            parcels::Nature::extensive;
    const ScalarSums sums = ordered_reduce(
        store.size(), ScalarSums{},
        [&](std::size_t begin, std::size_t end) {
          ScalarSums s;
          for (std::size_t p = begin; p < end; ++p) {
            s.sum += (per_volume ? volume[p] : 1.0) * value[p];
            s.low = std::min(s.low, value[p]);
            s.high = std::max(s.high, value[p]);
          }
          return s;
        },
        [](ScalarSums a, const ScalarSums& o) {
          return ScalarSums{a.sum + o.sum, std::min(a.low, o.low), std::max(a.high, o.high)};
        });
    const double mean = sums.sum / simulation.domain_volume();
    set(entry.mean, mean);
    set(entry.low, sums.low);
    set(entry.high, sums.high);
    if (entry.water) total_water += mean;
  }
  const std::vector<double> of_items = item_measures_.measure(store.items());
  for (std::size_t k = 0; k < of_items.size(); ++k) set(item_entries_[k], of_items[k]);
  total_water += budget_of_items(store.items(), water_budget) / simulation.domain_volume();
  if (total_water_ >= 0) set(total_water_, total_water);
}

void Diagnostics::observe_cloud(const Simulation& simulation) {
  if (rain_scalar_ >= 0)
    set(rain_path_, water_path_->measure(simulation, simulation.store().scalar(rain_scalar_)));
  if (liquid_scalar_ < 0) return;
  const parcels::Store& store = simulation.store();
  const double* volume = store.volume();
  const double* liquid = store.scalar(liquid_scalar_);
  const double* water = water_scalar_ >= 0 ? store.scalar(water_scalar_) : nullptr;
  const CloudSums sums = ordered_reduce(
      store.size(), CloudSums{},
      [&](std::size_t begin, std::size_t end) {
        CloudSums s;
        for (std::size_t p = begin; p < end; ++p) {
          s.liquid += volume[p] * liquid[p];
          s.high = std::max(s.high, liquid[p]);
          if (!(liquid[p] > cloud_threshold_)) continue;
          s.cloudy += volume[p];
          s.cloudy_liquid += volume[p] * liquid[p];
          s.liquid_squared += volume[p] * liquid[p] * liquid[p];
          if (water == nullptr) continue;
          s.cloudy_water += volume[p] * water[p];
          s.water_squared += volume[p] * water[p] * water[p];
        }
        return s;
      },
      [](CloudSums a, const CloudSums& o) { return a += o; });
  const double inverse = 1.0 / simulation.domain_volume();
  set(liquid_path_, water_path_->measure(simulation, liquid));
  set(mean_liquid_, sums.liquid * inverse);
  set(max_liquid_, sums.high);
  set(cloud_fraction_, sums.cloudy * inverse);
  set(cloud_mean_liquid_, sums.cloudy > 0 ? sums.cloudy_liquid / sums.cloudy : 0.0);
  set(cloud_liquid_deviation_, deviation(sums.cloudy, sums.cloudy_liquid, sums.liquid_squared));
  set(cloud_mean_water_, sums.cloudy > 0 ? sums.cloudy_water / sums.cloudy : 0.0);
  set(cloud_water_deviation_, deviation(sums.cloudy, sums.cloudy_water, sums.water_squared));
}

void Diagnostics::observe_surface() {
  for (std::size_t f = 0; f < surface_entries_.size(); ++f) {
    double sum = 0, high = -infinity;
    for (const double value : surface_.values(f)) {
      sum += value;
      high = std::max(high, value);
    }
    set(surface_entries_[f].mean, sum / static_cast<double>(surface_.columns()));
    set(surface_entries_[f].high, high);
  }
}

void Diagnostics::observe_velocity(Simulation& simulation) {
  const parcels::Store& store = simulation.store();
  const double* volume = store.volume();
  const int dimension = simulation.dimension();
  const double* w = simulation.velocity(dimension - 1);
  const VelocitySums sums = ordered_reduce(
      store.size(), VelocitySums{},
      [&](std::size_t begin, std::size_t end) {
        VelocitySums s;
        for (std::size_t p = begin; p < end; ++p) {
          double square = 0;
          for (int d = 0; d < dimension; ++d) {
            const double u = simulation.velocity(d)[p];
            square += u * u;
          }
          s.energy += 0.5 * volume[p] * square;
          s.speed2 = std::max(s.speed2, square);
          s.up = std::max(s.up, w[p]);
          s.down = std::min(s.down, w[p]);
        }
        return s;
      },
      [](VelocitySums a, const VelocitySums& o) {
        return VelocitySums{a.energy + o.energy, std::max(a.speed2, o.speed2), std::max(a.up, o.up),
                            std::min(a.down, o.down)};
      });
  set(kinetic_, sums.energy / simulation.domain_volume());
  set(max_speed_, std::sqrt(sums.speed2));
  set(max_vertical_velocity_, sums.up);
  set(min_vertical_velocity_, sums.down);
  set(mechanical_,
      values_[static_cast<std::size_t>(kinetic_)] + values_[static_cast<std::size_t>(potential_)]);
  set(total_,
      values_[static_cast<std::size_t>(kinetic_)] + values_[static_cast<std::size_t>(available_)]);
}

}  // namespace pileus::model

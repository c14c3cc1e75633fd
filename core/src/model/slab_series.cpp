#include "model/slab_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/nearest_word.hpp"
#include "model/cloud_extent.hpp"
#include "model/initial_state.hpp"
#include "scene/placed_error.hpp"

namespace pileus::model {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int density_points_per_cell = 16;  // as for the paths of water

/// What tells the mixed layer from the air above: the first of these that the run has.
int heat_profile(const SlabStatistics& slabs) {
  for (const char* name : {"liquid_water_potential_temperature", "air_potential_temperature",
                           "liquid_water_buoyancy", "buoyancy"})
    if (const int found = slabs.find(name); found >= 0) return found;
  return -1;
}

/// Unit of a measure of a profile in `units`.
std::string units_of(ProfileMeasure measure, const std::string& units) {
  if (measure == ProfileMeasure::height_of_min || measure == ProfileMeasure::height_of_max)
    return "m";
  if (measure == ProfileMeasure::nonlinearity) return "1";
  return measure == ProfileMeasure::slope ? product_of_units(units, "m-1") : units;
}

const std::vector<std::string>& measure_words() {
  static const std::vector<std::string> words = {"value", "mean",          "min",
                                                 "max",   "height_of_min", "height_of_max",
                                                 "slope", "nonlinearity",  "logarithmic_slope"};
  return words;
}

[[noreturn]] void refuse(const scene::SlabValueControl& control, const std::string& text) {
  throw scene::PlacedError(control.where,
                           fmt::format("the slab value '{}' {}", control.name, text));
}

constexpr const char* name_taken =
    "has the name of a diagnostic that this run has anyway; give the value another one.";

std::string mean_name(double from) {
  return fmt::format("slab_mean_from_{:.17g}", from);
}

}  // namespace

SlabSeries::SlabSeries(const scene::Scene& scene, const Simulation& simulation,
                       const coupling::SurfaceFields& surface, const SlabStatistics& slabs)
    : surface_(surface),
      slabs_(slabs),
      density_(profile_over_height(scene.diagnostics.water_path.density, scene,
                                   "the density of diagnostics.water_path", simulation.bottom(),
                                   simulation.bottom() + simulation.height(),
                                   density_points_per_cell * scene.domain.cells.back() + 1)),
      bottom_(simulation.bottom()),
      surface_flux_(surface.find("surface_buoyancy_flux")),
      buoyancy_flux_(slabs.find("buoyancy_flux")),
      heat_(heat_profile(slabs)) {
  list_flow();
  if (slabs.has_cloud()) list_cloud();
  list_asked(scene);
}

void SlabSeries::list_flow() {
  outputs_ = {{"inversion_height", "m", "height of the smallest vertical flux of buoyancy"},
              {"inversion_height_by_gradient", "m",
               "height of the steepest rise of the slab mean of " +
                   slabs_.variables()[static_cast<std::size_t>(heat_)].name},
              {"minimum_buoyancy_flux", "m2 s-3", "smallest slab flux of buoyancy"},
              {"max_z_velocity_variance", "m2 s-2", "largest slab variance of the upward velocity"},
              {"vertically_integrated_turbulent_kinetic_energy", "kg s-2",
               "resolved turbulent kinetic energy over an area of the ground"}};
  if (surface_flux_ < 0) return;
  outputs_.push_back({"entrainment_ratio", "1",
                      "smallest slab flux of buoyancy over that at the ground, negative"});
  outputs_.push_back({"convective_velocity_scale", "m s-1",
                      "cube root of the buoyancy flux at the ground times the inversion height"});
}

void SlabSeries::list_cloud() {
  const std::vector<std::array<std::string, 3>> cloud = {
      {"cloud_area_fraction", "1", "share of the columns of cells with cloudy air"},
      {"cloud_base_height", "m", "height of the lowest cloudy parcel"},
      {"cloud_top_height", "m", "height of the highest cloudy parcel"},
      {"max_cloud_fraction", "1", "largest share of cloudy air of a slab"},
      {"max_core_fraction", "1", "largest share of buoyant cloudy air of a slab"},
      {"max_core_mass_flux", "m s-1", "largest mass flux of buoyant cloudy air of a slab"}};
  outputs_.insert(outputs_.end(), cloud.begin(), cloud.end());
}

SlabSeries::Asked SlabSeries::asked(const scene::SlabValueControl& control,
                                    const scene::Domain& domain, const SlabStatistics& slabs) {
  const double bottom = domain.lower.back(), top = bottom + domain.extent.back();
  Asked asked{control, slabs.find(control.variable), bottom, top};
  if (asked.profile < 0) {
    std::vector<std::string> names;
    for (const output::Variable& variable : slabs.variables()) names.push_back(variable.name);
    const std::string nearest = nearest_word(control.variable, names);
    refuse(control,
           fmt::format("is of '{}', of which there is no slab profile in this run; {}",
                       control.variable,
                       nearest.empty() ? fmt::format("there are {}.", fmt::join(names, ", "))
                                       : fmt::format("did you mean '{}'?", nearest)));
  }
  if (control.height) asked.low = asked.high = *control.height;
  if (!control.between.empty()) {
    asked.low = control.between.at(0);
    asked.high = control.between.at(1);
  }
  if (asked.high < bottom || asked.low > top || asked.low < bottom || asked.high > top)
    refuse(control, fmt::format("is sought outside the domain, which reaches from {:.6g} m to "
                                "{:.6g} m.",
                                bottom, top));
  const double spacing = slabs.spacing();
  const double levels = std::floor((asked.high - bottom) / spacing + 1e-9) -
                        std::ceil((asked.low - bottom) / spacing - 1e-9) + 1;
  const bool line = control.measure == ProfileMeasure::slope ||
                    control.measure == ProfileMeasure::nonlinearity ||
                    control.measure == ProfileMeasure::logarithmic_slope;
  if (control.measure != ProfileMeasure::value && levels < (line ? 2 : 1))
    refuse(control, fmt::format("needs at least {} between its heights, which are {:.6g} m and "
                                "{:.6g} m; levels are {:.6g} m apart.",
                                line ? "two levels" : "one level", asked.low, asked.high, spacing));
  return asked;
}

void SlabSeries::check(const scene::Scene& scene, const parcels::Store& store) {
  if (scene.diagnostics.slabs.values.empty()) return;
  const SlabStatistics slabs(scene, store);
  for (const scene::SlabValueControl& control : scene.diagnostics.slabs.values)
    asked(control, scene.domain, slabs);
}

void SlabSeries::list_asked(const scene::Scene& scene) {
  for (const scene::SlabValueControl& control : scene.diagnostics.slabs.values) {
    asked_.push_back(asked(control, scene.domain, slabs_));
    if (control.averaged_from) means_.try_emplace(*control.averaged_from);
    const output::Variable& variable =
        slabs_.variables()[static_cast<std::size_t>(asked_.back().profile)];
    for (const auto& other : outputs_)
      if (other[0] == control.name) refuse(control, name_taken);
    std::string text =
        fmt::format("{} of the slab profile {}",
                    measure_words()[static_cast<std::size_t>(control.measure)], variable.name);
    if (control.averaged_from) text += fmt::format(", mean since {:.6g} s", *control.averaged_from);
    outputs_.push_back({control.name, units_of(control.measure, variable.units), text});
  }
}

void SlabSeries::refuse_taken(const std::function<bool(const std::string& name)>& is_taken) const {
  for (const Asked& asked : asked_)
    if (is_taken(asked.control.name)) refuse(asked.control, name_taken);
}

std::vector<double> SlabSeries::observe(const Simulation& simulation) {
  std::vector<double> values;
  observe_flow(values);
  if (slabs_.has_cloud()) observe_cloud(simulation, values);
  observe_asked(simulation.time(), values);
  return values;
}

double SlabSeries::largest(const char* name) {
  const Profile profile = slabs_.profile(slabs_.find(name), profile_);
  return measure(profile, ProfileMeasure::max, profile.height(0),
                 profile.height(slabs_.levels() - 1));
}

double SlabSeries::mean_surface_flux() const {
  double sum = 0;
  for (const double flux : surface_.values(static_cast<std::size_t>(surface_flux_))) sum += flux;
  return sum / static_cast<double>(surface_.columns());
}

/// ∫ρ ½⟨u′² + v′² + w′²⟩ dz by the trapezoidal rule.
double SlabSeries::turbulent_kinetic_energy() {
  double sum = 0;
  for (const char* name : {"x_velocity_variance", "y_velocity_variance", "z_velocity_variance"}) {
    const int number = slabs_.find(name);
    if (number < 0) continue;
    const Profile profile = slabs_.profile(number, profile_);
    for (std::size_t k = 0; k < slabs_.levels(); ++k) {
      const double weight = k == 0 || k + 1 == slabs_.levels() ? 0.5 : 1.0;
      sum += weight * density_(profile.height(k)) * 0.5 * profile_[k];
    }
  }
  return sum * slabs_.spacing();
}

void SlabSeries::observe_flow(std::vector<double>& values) {
  const Profile flux = slabs_.profile(buoyancy_flux_, profile_);
  const double inversion = height_of_smallest(flux);
  const double least =
      measure(flux, ProfileMeasure::min, flux.height(0), flux.height(slabs_.levels() - 1));
  slabs_.profile(heat_, profile_);
  std::vector<double> rise;
  for (std::size_t k = 0; k + 1 < profile_.size(); ++k)
    rise.push_back(profile_[k + 1] - profile_[k]);
  const double spacing = slabs_.spacing();
  const double steepest = height_of_largest({rise, bottom_ + 0.5 * spacing, spacing});
  const double energy = turbulent_kinetic_energy();
  values.insert(values.end(), {inversion, steepest, least, largest("z_velocity_variance"), energy});
  if (surface_flux_ < 0) return;
  const double given = mean_surface_flux();
  values.push_back(given != 0 ? -least / given : nan);
  // The scale of Deardorff (1970), J. Atmos. Sci. 27, 1211, heights counted from the ground.
  values.push_back(given > 0 ? std::cbrt(given * (inversion - bottom_)) : 0.0);
}

void SlabSeries::observe_cloud(const Simulation& simulation, std::vector<double>& values) {
  const CloudExtent extent = cloud_extent(
      simulation, simulation.store().scalar(slabs_.liquid_scalar()), slabs_.cloud_threshold());
  values.insert(values.end(), {extent.cover, extent.base, extent.top, largest("cloud_fraction"),
                               largest("core_fraction"), largest("core_mass_flux")});
}

void SlabSeries::observe_asked(double time, std::vector<double>& values) {
  for (auto& [from, mean] : means_)
    if (time >= from && time > mean.latest()) mean.add(time, slabs_.moments());
  for (const Asked& asked : asked_) {
    const RunningMean* mean =
        asked.control.averaged_from ? &means_.at(*asked.control.averaged_from) : nullptr;
    if (mean != nullptr && mean->samples() == 0) {
      values.push_back(nan);
      continue;
    }
    if (mean != nullptr) {
      mean->mean(moments_);
      slabs_.profile(moments_, asked.profile, profile_);
    } else {
      slabs_.profile(slabs_.moments(), asked.profile, profile_);
    }
    values.push_back(
        measure(slabs_.on_levels(profile_), asked.control.measure, asked.low, asked.high));
  }
}

void SlabSeries::save(output::NamedData& data, double time) const {
  for (const auto& [from, mean] : means_) mean.save(data, mean_name(from), time);
}

void SlabSeries::restore(const output::NamedData& data) {
  for (auto& [from, mean] : means_) mean.restore(data, mean_name(from), slabs_.moments().size());
}

}  // namespace pileus::model

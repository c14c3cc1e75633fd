#include "model/output_streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/quantities.hpp"

namespace pileus::model {
namespace {

/// Fills in what the register of quantities knows about a variable.
output::Variable described(output::Variable variable) {
  if (const Quantity* q = find_quantity(variable.name)) {
    variable.long_name = std::string(q->definition);
    variable.standard_name = std::string(q->standard_name);
  }
  return variable;
}

std::string standard_name_of(const std::string& name) {
  const Quantity* q = find_quantity(name);
  return q != nullptr ? std::string(q->standard_name) : std::string();
}

/// The wanted variables out of those that exist, in the wanted order; all when none is named.
std::vector<output::Variable> choose(const std::vector<std::string>& wanted,
                                     const std::vector<output::Variable>& existing,
                                     const std::string& stream) {
  std::vector<output::Variable> chosen;
  std::vector<std::string> names;
  for (const auto& variable : existing) names.push_back(variable.name);
  if (wanted.empty()) {
    for (const auto& variable : existing) chosen.push_back(described(variable));
    return chosen;
  }
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const std::string nearest = nearest_word(name, names);
      throw Error(ExitCode::usage,
                  fmt::format("output.{}: there is no variable '{}' in this run; {}.", stream, name,
                              nearest.empty() ? fmt::format("it has {}", fmt::join(names, ", "))
                                              : fmt::format("did you mean '{}'?", nearest)));
    }
    chosen.push_back(described(existing[static_cast<std::size_t>(found - names.begin())]));
  }
  return chosen;
}

std::vector<output::Variable> parcel_columns(const parcels::Store& store) {
  std::vector<output::Variable> columns;
  for (int c = store.dimension(); c < store.column_count(); ++c) {
    const std::string name = store.column_name(c);
    const int scalar = c - store.first_scalar();
    std::string units = store.dimension() == 3 ? "m3" : "m2";
    if (c > store.dimension()) units = "s-1";
    if (c > store.dimension() + store.vorticity_components()) units = "m2";
    if (scalar >= 0) units = store.scalars()[static_cast<std::size_t>(scalar)].units;
    columns.push_back({name, units, name, ""});
  }
  return columns;
}

std::vector<output::Variable> ground_variables(const coupling::SurfaceFields& surface) {
  std::vector<output::Variable> variables;
  for (const coupling::SurfaceQuantity& quantity : surface.list())
    variables.push_back({quantity.name, quantity.units, quantity.name, ""});
  return variables;
}

/// Horizontal means of every field, the variance of the upward velocity and the buoyancy flux.
std::vector<output::Variable> profile_variables(const std::vector<output::Variable>& fields) {
  std::vector<output::Variable> variables;
  for (const auto& field : fields) {
    output::Variable mean = described(field);
    mean.standard_name.clear();
    mean.long_name = "horizontal mean of " + mean.long_name;
    variables.push_back(mean);
  }
  variables.push_back({"z_velocity_variance", "m2 s-2", "variance of the upward velocity", ""});
  variables.push_back({"buoyancy_flux", "m2 s-3", "resolved vertical flux of buoyancy", ""});
  return variables;
}

std::vector<std::string> names_of(const std::vector<output::Variable>& variables) {
  std::vector<std::string> names;
  for (const output::Variable& variable : variables) names.push_back(variable.name);
  return names;
}

output::Encoding encoding_of(const scene::OutputControl& control) {
  return {false, control.compress, control.mantissa_bits};
}

}  // namespace

double Schedule::next() const {
  return every_ > 0 ? count_ * every_ : std::numeric_limits<double>::infinity();
}

double Schedule::next_after(double time) const {
  if (!(every_ > 0)) return std::numeric_limits<double>::infinity();
  return (std::floor(time / every_ + 1e-9) + 1) * every_;
}

void Schedule::done(double time) {
  if (every_ > 0) count_ = std::floor(time / every_ + 1e-9) + 1;
}

OutputStreams::OutputStreams(const scene::Scene& scene, const Simulation& simulation,
                             const coupling::SurfaceFields& surface, const Record& record,
                             const output::RunDirectory& directory,
                             const output::Provenance& provenance, output::Start start)
    : surface_(surface),
      fields_schedule_(scene.output.fields.every),
      parcels_schedule_(scene.output.parcels.every),
      profiles_schedule_(scene.output.profiles.every),
      series_schedule_(scene.output.series.every),
      spectra_schedule_(scene.output.spectra.every),
      droplets_schedule_(scene.output.droplets.every) {
  const std::vector<output::Variable> fields = simulation.grid_fields();
  if (scene.output.fields.every > 0)
    open_fields(scene.output, simulation, directory / "fields.nc", provenance, start);
  if (scene.output.parcels.every > 0)
    parcels_ = std::make_unique<output::ParcelFile>(
        directory / "parcels.nc", simulation.dimension(),
        choose(scene.output.parcels.variables, parcel_columns(simulation.store()), "parcels"),
        provenance, encoding_of(scene.output), start);
  if (scene.output.profiles.every > 0) {
    profile_variables_ =
        choose(scene.output.profiles.variables, profile_variables(fields), "profiles");
    profiles_ =
        std::make_unique<output::ProfileFile>(directory / "profiles.nc", simulation.axes().front(),
                                              profile_variables_, provenance, start);
  }
  open_item_streams(scene.output, simulation, directory, provenance, start);
  std::vector<output::Variable> numbers;
  for (const DiagnosticInfo& d : record.list())
    numbers.push_back({d.name, d.units, d.long_name, standard_name_of(d.name)});
  series_ =
      std::make_unique<output::SeriesFile>(directory / "series.nc", numbers, provenance, start);
}

void OutputStreams::open_fields(const scene::OutputControl& control, const Simulation& simulation,
                                const std::filesystem::path& path,
                                const output::Provenance& provenance, output::Start start) {
  std::vector<output::Variable> existing = simulation.grid_fields();
  const std::vector<output::Variable> ground = ground_variables(surface_);
  existing.insert(existing.end(), ground.begin(), ground.end());
  for (output::Variable& variable : choose(control.fields.variables, existing, "fields")) {
    const bool on_ground = surface_.find(variable.name) >= 0;
    (on_ground ? ground_variables_ : field_variables_).push_back(std::move(variable));
  }
  fields_ = std::make_unique<output::FieldFile>(
      path, simulation.axes(), field_variables_, provenance, encoding_of(control), start,
      output::VariableSet{simulation.ground_axes(), ground_variables_});
}

void OutputStreams::open_item_streams(const scene::OutputControl& control,
                                      const Simulation& simulation,
                                      const output::RunDirectory& directory,
                                      const output::Provenance& provenance, output::Start start) {
  const parcels::Store& store = simulation.store();
  if (control.spectra.every > 0) {
    size_spectra_ = std::make_unique<SizeSpectra>(control.spectra, simulation);
    const output::VariableSet& gridded = size_spectra_->gridded();
    const output::VariableSet& means = size_spectra_->means();
    // The axis that both have in common is written once: with the first set that has variables.
    spectra_ = std::make_unique<output::RecordFile>(
        directory / "spectra.nc", gridded.variables.empty() ? means : gridded,
        gridded.variables.empty() ? output::VariableSet{} : means, provenance, encoding_of(control),
        start);
  }
  if (control.droplets.every > 0) {
    if (!store.items().exist())
      throw Error(ExitCode::usage, "output.droplets: no operator of this run makes droplets.");
    std::vector<output::Variable> variables = output::item_variables(store.items());
    for (output::Variable& variable : variables) variable = described(variable);
    droplets_ = std::make_unique<output::ItemFile>(directory / "droplets.nc", store, variables,
                                                   control.droplets.fraction, provenance,
                                                   encoding_of(control), start);
  }
}

/// Profiles and the series are frequent: they take the first step at or after their time, so that
/// they do not shorten the steps.
double OutputStreams::next_landing_after(double time) const {
  return std::min({fields_schedule_.next_after(time), parcels_schedule_.next_after(time),
                   spectra_schedule_.next_after(time), droplets_schedule_.next_after(time)});
}

void OutputStreams::write_due(Simulation& simulation, bool last) {
  const double time = simulation.time();
  if (fields_ && (last || fields_schedule_.due(time)) && time > field_time_) {
    write_fields(simulation);
    fields_schedule_.done(time);
    field_time_ = time;
  }
  if (parcels_ && (last || parcels_schedule_.due(time)) && time > parcel_time_) {
    parcels_->append(time, simulation.store());
    parcels_schedule_.done(time);
    parcel_time_ = time;
  }
  if (profiles_ && (last || profiles_schedule_.due(time)) && time > profile_time_) {
    write_profiles(simulation);
    profiles_schedule_.done(time);
    profile_time_ = time;
  }
  write_item_streams(simulation, last);
}

void OutputStreams::write_item_streams(const Simulation& simulation, bool last) {
  const double time = simulation.time();
  if (spectra_ && (last || spectra_schedule_.due(time)) && time > spectra_time_) {
    size_spectra_->measure(simulation, values_);
    spectra_->append(time, values_);
    spectra_schedule_.done(time);
    spectra_time_ = time;
  }
  if (droplets_ && (last || droplets_schedule_.due(time)) && time > droplet_time_) {
    droplets_->append(time, simulation.store());
    droplets_schedule_.done(time);
    droplet_time_ = time;
  }
}

void OutputStreams::write_fields(Simulation& simulation) {
  simulation.grid(names_of(field_variables_), values_);
  for (const output::Variable& variable : ground_variables_)
    values_.push_back(surface_.values(static_cast<std::size_t>(surface_.find(variable.name))));
  fields_->append(simulation.time(), values_);
}

void OutputStreams::write_profiles(Simulation& simulation) {
  const std::size_t levels = profiles_->record_size();
  const std::size_t columns = simulation.node_count() / levels;
  const auto mean_of_product = [&](const std::vector<double>& a, const std::vector<double>* b) {
    std::vector<double> mean(levels, 0.0);
    for (std::size_t k = 0; k < levels; ++k) {
      for (std::size_t c = 0; c < columns; ++c)
        mean[k] += a[k * columns + c] * (b ? (*b)[k * columns + c] : 1.0);
      mean[k] /= static_cast<double>(columns);
    }
    return mean;
  };
  const auto is_product = [](const std::string& name) {
    return name == "z_velocity_variance" || name == "buoyancy_flux";
  };
  std::vector<std::string> names = names_of(profile_variables_);
  std::erase_if(names, is_product);
  const std::size_t means = names.size();
  names.insert(names.end(), {"z_velocity", "buoyancy"});
  std::vector<std::vector<double>> fields;
  simulation.grid(names, fields);
  const std::vector<double>&w = fields[means], &b = fields[means + 1];
  const std::vector<double> mean_w = mean_of_product(w, nullptr),
                            mean_b = mean_of_product(b, nullptr);
  values_.resize(profile_variables_.size());
  for (std::size_t v = 0, next = 0; v < profile_variables_.size(); ++v) {
    const std::string& name = profile_variables_[v].name;
    if (!is_product(name)) {
      values_[v] = mean_of_product(fields[next++], nullptr);
      continue;
    }
    const bool variance = name == "z_velocity_variance";
    values_[v] = mean_of_product(w, variance ? &w : &b);
    for (std::size_t k = 0; k < levels; ++k)
      values_[v][k] -= mean_w[k] * (variance ? mean_w[k] : mean_b[k]);
  }
  profiles_->append(simulation.time(), values_);
}

void OutputStreams::flush_series(const Record& record) {
  const std::vector<double>& written = series_->times();
  std::size_t first = 0;
  while (first < record.size() && !written.empty() && record.times()[first] <= written.back())
    ++first;
  if (first == record.size()) return;
  const std::vector<double> times(record.times().begin() + static_cast<std::ptrdiff_t>(first),
                                  record.times().end());
  std::vector<std::vector<double>> values;
  for (std::size_t d = 0; d < record.list().size(); ++d) {
    const std::vector<double>& series = record.series(d);
    values.emplace_back(series.begin() + static_cast<std::ptrdiff_t>(first), series.end());
  }
  series_->append_records(times, values);
}

void OutputStreams::resume(const Record& record) {
  // Not from the time of the checkpoint: a stream on which steps do not land may be overdue there.
  if (fields_) fields_schedule_.resume_after(fields_->records().times());
  if (parcels_) parcels_schedule_.resume_after(parcels_->times());
  if (profiles_) profiles_schedule_.resume_after(profiles_->times());
  series_schedule_.resume_after(record.times());
  if (spectra_) spectra_schedule_.resume_after(spectra_->times());
  if (droplets_) droplets_schedule_.resume_after(droplets_->times());
}

std::vector<output::OutputSummary> OutputStreams::summarise() const {
  std::vector<output::OutputSummary> list;
  const auto add = [&](const char* name, const char* content, std::size_t records) {
    list.push_back({name, content, records});
  };
  if (fields_) add("fields.nc", "gridded fields over time", fields_->records().times().size());
  if (profiles_) add("profiles.nc", "horizontal means over time", profiles_->times().size());
  add("series.nc", "diagnostics over time", series_->times().size());
  if (parcels_) add("parcels.nc", "all parcels at some times", parcels_->times().size());
  if (spectra_) add("spectra.nc", "size spectra of droplets over time", spectra_->times().size());
  if (droplets_) add("droplets.nc", "droplets at some times", droplets_->times().size());
  return list;
}

}  // namespace pileus::model

#include "model/output_streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "model/output_variables.hpp"

namespace pileus::model {
namespace {

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

output::Encoding encoding_of(const scene::OutputControl& control) {
  return {false, control.compress, control.mantissa_bits};
}

}  // namespace

OutputStreams::OutputStreams(const scene::Scene& scene, const Simulation& simulation,
                             const coupling::SurfaceFields& surface, const SlabStatistics* slabs,
                             const Record& record, const output::RunDirectory& directory,
                             const output::Provenance& provenance, output::Start start)
    : surface_(surface),
      fields_schedule_(scene.output.fields.every),
      parcels_schedule_(scene.output.parcels.every),
      series_schedule_(scene.output.series.every),
      spectra_schedule_(scene.output.spectra.every),
      droplets_schedule_(scene.output.droplets.every) {
  if (scene.output.fields.every > 0)
    open_fields(scene.output, simulation, directory / "fields.nc", provenance, start);
  if (scene.output.parcels.every > 0)
    parcels_ = std::make_unique<output::ParcelFile>(
        directory / "parcels.nc", simulation.dimension(),
        choose(scene.output.parcels.variables, parcel_columns(simulation.store()), "parcels"),
        provenance, encoding_of(scene.output), start);
  if (scene.output.profiles.every > 0)
    profiles_ = std::make_unique<ProfileStream>(scene.output.profiles, simulation, slabs,
                                                directory / "profiles.nc", provenance, start);
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
  if (profiles_) profiles_->take_grid(simulation, last);
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

void OutputStreams::resume(const Record& record, const output::NamedData& data) {
  // Not from the time of the checkpoint: a stream on which steps do not land may be overdue there.
  if (fields_) fields_schedule_.resume_after(fields_->records().times());
  if (parcels_) parcels_schedule_.resume_after(parcels_->times());
  if (profiles_) profiles_->resume(data);
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

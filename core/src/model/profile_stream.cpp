#include "model/profile_stream.hpp"

#include <algorithm>
#include <utility>

#include "model/output_variables.hpp"

namespace pileus::model {
namespace {

constexpr const char* state_name = "profile_samples";
/// What tells a statistic of slabs from the mean over the mesh of the same name.
constexpr const char* slab_suffix = "_of_parcels";

/// Horizontal means of every field, the variance of the upward velocity and the buoyancy flux.
std::vector<output::Variable> mesh_variables(const std::vector<output::Variable>& fields) {
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

bool is_product(const std::string& name) {
  return name == "z_velocity_variance" || name == "buoyancy_flux";
}

/// The mean over time belongs to a variable whose values are means over samples.
std::string over_time(const std::string& methods) {
  if (methods.empty() || methods == "area: mean") return "time: mean area: mean";
  return methods + " time: mean";
}

}  // namespace

ProfileStream::ProfileStream(const scene::OutputStream& control, const Simulation& simulation,
                             const SlabStatistics* slabs, const std::filesystem::path& path,
                             const output::Provenance& provenance, output::Start start)
    : slabs_(slabs),
      averaged_(control.sample.has_value()),
      schedule_(control.every),
      sample_schedule_(control.sample.value_or(0)),
      levels_(simulation.axes().front().values.size()) {
  name_variables(control, simulation);
  file_ = std::make_unique<output::ProfileFile>(path, simulation.axes().front(), variables_,
                                                provenance, start, averaged_);
}

void ProfileStream::name_variables(const scene::OutputStream& control,
                                   const Simulation& simulation) {
  const std::vector<output::Variable> mesh = mesh_variables(simulation.grid_fields());
  std::vector<output::Variable> existing = mesh;
  std::vector<std::string> of_mesh = names_of(mesh), of_slabs;
  const auto clashes = [&](const std::string& name) {
    return std::find(of_mesh.begin(), of_mesh.end(), name) != of_mesh.end();
  };
  if (slabs_ != nullptr)
    for (output::Variable variable : slabs_->variables()) {
      if (clashes(variable.name)) variable.name += slab_suffix;
      of_slabs.push_back(variable.name);
      existing.push_back(std::move(variable));
    }
  std::vector<output::Variable> slab_variables;
  for (output::Variable& variable : choose(control.variables, existing, "profiles")) {
    if (averaged_) variable.cell_methods = over_time(variable.cell_methods);
    const auto slab = std::find(of_slabs.begin(), of_slabs.end(), variable.name);
    if (slab == of_slabs.end()) {
      variables_.push_back(std::move(variable));
      continue;
    }
    slab_numbers_.push_back(static_cast<int>(slab - of_slabs.begin()));
    slab_variables.push_back(std::move(variable));
  }
  of_mesh_ = variables_.size();
  variables_.insert(variables_.end(), slab_variables.begin(), slab_variables.end());
}

/// A record without samples of its own takes the state it is written at.
bool ProfileStream::samples(double time, bool last) const {
  if (!averaged_) return records(time, last);
  if (sample_schedule_.due(time) && time > samples_.latest()) return true;
  return samples_.samples() == 0 && records(time, last);
}

void ProfileStream::take_grid(Simulation& simulation, bool last) {
  const double time = simulation.time();
  sample_due_ = samples(time, last);
  record_due_ = records(time, last);
  if (sample_due_) sample_grid(simulation);
  if (slab_numbers_.empty()) take(time);
}

void ProfileStream::take_slabs(double time) {
  if (slab_numbers_.empty()) return;
  if (sample_due_) {
    const std::span<const double> moments = slabs_->moments();
    sample_.insert(sample_.end(), moments.begin(), moments.end());
  }
  take(time);
}

void ProfileStream::take(double time) {
  if (sample_due_) {
    if (times().empty() && samples_.samples() == 0) interval_start_ = time;
    samples_.add(time, sample_);
    sample_schedule_.done(time);
  }
  if (record_due_) write(time);
  sample_due_ = record_due_ = false;
}

void ProfileStream::write(double time) {
  samples_.mean(mean_);
  const std::size_t of_mesh = of_mesh_ * levels_;
  values_.resize(variables_.size());
  for (std::size_t v = 0; v < of_mesh_; ++v) {
    const auto first = mean_.begin() + static_cast<std::ptrdiff_t>(v * levels_);
    values_[v].assign(first, first + static_cast<std::ptrdiff_t>(levels_));
  }
  for (std::size_t i = 0; i < slab_numbers_.size(); ++i)
    slabs_->profile(std::span(mean_).subspan(of_mesh), slab_numbers_[i], values_[of_mesh_ + i]);
  if (averaged_) values_.push_back({times().empty() ? interval_start_ : times().back(), time});
  file_->append(time, values_);
  samples_.clear(time);
  schedule_.done(time);
  record_time_ = time;
}

/// Means over the nodes of every level, one variable after another.
void ProfileStream::sample_grid(Simulation& simulation) {
  const std::size_t columns = simulation.node_count() / levels_;
  const auto mean_of_product = [&](const std::vector<double>& a, const std::vector<double>* b) {
    std::vector<double> mean(levels_, 0.0);
    for (std::size_t k = 0; k < levels_; ++k) {
      for (std::size_t c = 0; c < columns; ++c)
        mean[k] += a[k * columns + c] * (b ? (*b)[k * columns + c] : 1.0);
      mean[k] /= static_cast<double>(columns);
    }
    return mean;
  };
  std::vector<std::string> names;
  for (std::size_t v = 0; v < of_mesh_; ++v)
    if (!is_product(variables_[v].name)) names.push_back(variables_[v].name);
  const std::size_t means = names.size();
  names.insert(names.end(), {"z_velocity", "buoyancy"});
  simulation.grid(names, fields_);
  const std::vector<double>&w = fields_[means], &b = fields_[means + 1];
  const std::vector<double> mean_w = mean_of_product(w, nullptr),
                            mean_b = mean_of_product(b, nullptr);
  sample_.clear();
  for (std::size_t v = 0, next = 0; v < of_mesh_; ++v) {
    std::vector<double> values;
    if (!is_product(variables_[v].name)) {
      values = mean_of_product(fields_[next++], nullptr);
    } else {
      const bool variance = variables_[v].name == "z_velocity_variance";
      values = mean_of_product(w, variance ? &w : &b);
      for (std::size_t k = 0; k < levels_; ++k)
        values[k] -= mean_w[k] * (variance ? mean_w[k] : mean_b[k]);
    }
    sample_.insert(sample_.end(), values.begin(), values.end());
  }
}

void ProfileStream::save(output::NamedData& data, double time) const {
  if (!averaged_) return;
  samples_.save(data, state_name, time);
  data.arrays[std::string(state_name) + "/interval_start"] = {interval_start_};
}

void ProfileStream::resume(const output::NamedData& data) {
  // Not from the time of the checkpoint: steps do not land on records, which may be overdue there.
  schedule_.resume_after(times());
  if (!averaged_) return;
  const std::size_t moments = slab_numbers_.empty() ? 0 : slabs_->moments().size();
  samples_.restore(data, state_name, of_mesh_ * levels_ + moments);
  if (samples_.latest() >= 0) sample_schedule_.done(samples_.latest());
  const auto start = data.arrays.find(std::string(state_name) + "/interval_start");
  if (start != data.arrays.end() && start->second.size() == 1) interval_start_ = start->second[0];
}

}  // namespace pileus::model

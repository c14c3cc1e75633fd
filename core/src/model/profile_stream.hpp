// profiles.nc: means over the mesh and statistics of slabs by height, of one state or averaged over
// samples.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "model/running_mean.hpp"
#include "model/schedule.hpp"
#include "model/simulation.hpp"
#include "model/slab_statistics.hpp"
#include "output/field_file.hpp"
#include "output/named_data.hpp"
#include "output/start.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// Of one state it takes the mesh first, then, with statistics of slabs, those: measuring them
/// spoils the flow on the mesh.
class ProfileStream {
 public:
  /// `slabs`: null without such statistics; else it has to outlive this.
  ProfileStream(const scene::OutputStream& control, const Simulation& simulation,
                const SlabStatistics* slabs, const std::filesystem::path& path,
                const output::Provenance& provenance, output::Start start);

  /// Whether take_grid() of this time will need take_slabs() after it.
  bool wants_slabs(double time, bool last) const {
    return !slab_numbers_.empty() && (samples(time, last) || records(time, last));
  }
  /// Samples the evaluated state and writes a record if they are due; `last`: writes one.
  void take_grid(Simulation& simulation, bool last);
  /// Whether take_grid() of the present state left something for take_slabs().
  bool waits_for_slabs() const { return !slab_numbers_.empty() && (sample_due_ || record_due_); }
  /// After the slabs of the same state have been measured.
  void take_slabs(double time);

  const std::vector<double>& times() const { return file_->times(); }

  /// What a run that continues at `time` (s) has to know; nothing where every record is one state.
  void save(output::NamedData& data, double time) const;
  void resume(const output::NamedData& data);

 private:
  bool records(double time, bool last) const {
    return (last || schedule_.due(time)) && time > record_time_;
  }
  bool samples(double time, bool last) const;
  void name_variables(const scene::OutputStream& control, const Simulation& simulation);
  void take(double time);
  void write(double time);
  void sample_grid(Simulation& simulation);

  const SlabStatistics* slabs_;
  bool averaged_;
  Schedule schedule_, sample_schedule_;
  std::vector<output::Variable> variables_;  // of the mesh, then of slabs
  std::size_t of_mesh_ = 0;
  std::vector<int> slab_numbers_;
  std::size_t levels_;
  std::unique_ptr<output::ProfileFile> file_;
  std::vector<double> sample_, mean_;
  std::vector<std::vector<double>> fields_, values_;
  RunningMean samples_;
  double record_time_ = -1, interval_start_ = 0;
  bool sample_due_ = false, record_due_ = false;
};

}  // namespace pileus::model

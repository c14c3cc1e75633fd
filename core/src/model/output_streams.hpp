// What a run writes while it goes on: fields, parcels, profiles, the series of diagnostics.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "model/profile_stream.hpp"
#include "model/record.hpp"
#include "model/schedule.hpp"
#include "model/simulation.hpp"
#include "model/size_spectra.hpp"
#include "output/field_file.hpp"
#include "output/item_file.hpp"
#include "output/named_data.hpp"
#include "output/parcel_file.hpp"
#include "output/run_directory.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

class OutputStreams {
 public:
  /// Creates the writers of the streams the scene switches on. Throws Error (usage) for variables
  /// that do not exist, with the nearest that do. `surface` and `slabs` have to outlive this;
  /// without `slabs` there are no statistics of slabs.
  OutputStreams(const scene::Scene& scene, const Simulation& simulation,
                const coupling::SurfaceFields& surface, const SlabStatistics* slabs,
                const Record& record, const output::RunDirectory& directory,
                const output::Provenance& provenance, output::Start start);

  /// First time after `time` at which a stream wants the state, for the steps to land on (s).
  double next_landing_after(double time) const;
  bool series_due(double time) const { return series_schedule_.due(time); }
  void series_done(double time) { series_schedule_.done(time); }

  /// Whether the profiles will ask for the statistics of the state's slabs.
  bool wants_slabs(double time, bool last) const {
    return profiles_ && profiles_->wants_slabs(time, last);
  }

  /// Writes whatever is due at the evaluated state; `last` writes a record of every stream.
  void write_due(Simulation& simulation, bool last);
  bool has_open_profiles() const { return profiles_ && profiles_->waits_for_slabs(); }
  /// What write_due() left open: once the slabs of the same state have been measured.
  void write_slabs(double time) { profiles_->take_slabs(time); }
  /// Brings the file of the series up to date with the record.
  void flush_series(const Record& record);
  /// Goes on after what the files of a resumed run, its record and its checkpoint hold.
  void resume(const Record& record, const output::NamedData& data);
  /// What a run that continues at `time` (s) has to know.
  void save(output::NamedData& data, double time) const {
    if (profiles_) profiles_->save(data, time);
  }

  std::vector<output::OutputSummary> summarise() const;

 private:
  void open_fields(const scene::OutputControl& control, const Simulation& simulation,
                   const std::filesystem::path& path, const output::Provenance& provenance,
                   output::Start start);
  void write_fields(Simulation& simulation);
  void open_item_streams(const scene::OutputControl& control, const Simulation& simulation,
                         const output::RunDirectory& directory,
                         const output::Provenance& provenance, output::Start start);
  void write_item_streams(const Simulation& simulation, bool last);

  const coupling::SurfaceFields& surface_;
  Schedule fields_schedule_, parcels_schedule_, series_schedule_;
  Schedule spectra_schedule_, droplets_schedule_;
  std::vector<output::Variable> field_variables_, ground_variables_;
  std::unique_ptr<output::FieldFile> fields_;
  std::unique_ptr<output::ParcelFile> parcels_;
  std::unique_ptr<ProfileStream> profiles_;
  std::unique_ptr<output::SeriesFile> series_;
  std::unique_ptr<SizeSpectra> size_spectra_;
  std::unique_ptr<output::RecordFile> spectra_;
  std::unique_ptr<output::ItemFile> droplets_;
  std::vector<std::vector<double>> values_;
  double field_time_ = -1, parcel_time_ = -1, spectra_time_ = -1, droplet_time_ = -1;
};

}  // namespace pileus::model

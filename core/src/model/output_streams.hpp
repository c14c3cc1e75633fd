// What a run writes while it goes on: fields, parcels, profiles, the series of diagnostics.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "model/record.hpp"
#include "model/simulation.hpp"
#include "model/size_spectra.hpp"
#include "output/field_file.hpp"
#include "output/item_file.hpp"
#include "output/parcel_file.hpp"
#include "output/run_directory.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// Multiples of an interval, without drift.
class Schedule {
 public:
  /// `every` ≤ 0: never.
  explicit Schedule(double every) : every_(every) {}
  /// Next multiple that is not done (s), infinity when never.
  double next() const;
  /// First multiple after `time` (s), infinity when never.
  double next_after(double time) const;
  bool due(double time) const { return time >= next() - 1e-9 * every_; }
  /// The record of `time` is written: the next one is the first multiple after it.
  void done(double time);
  /// Goes on after records of these times.
  void resume_after(const std::vector<double>& written) {
    if (!written.empty()) done(written.back());
  }

 private:
  double every_;
  double count_ = 0;
};

class OutputStreams {
 public:
  /// Creates the writers of the streams the scene switches on. Throws Error (usage) for variables
  /// that do not exist, with the nearest that do. `surface` has to outlive this.
  OutputStreams(const scene::Scene& scene, const Simulation& simulation,
                const coupling::SurfaceFields& surface, const Record& record,
                const output::RunDirectory& directory, const output::Provenance& provenance,
                output::Start start);

  /// First time after `time` at which a stream wants the state, for the steps to land on (s).
  double next_landing_after(double time) const;
  bool series_due(double time) const { return series_schedule_.due(time); }
  void series_done(double time) { series_schedule_.done(time); }

  /// Writes whatever is due at the evaluated state; `last` writes a record of every stream.
  void write_due(Simulation& simulation, bool last);
  /// Brings the file of the series up to date with the record.
  void flush_series(const Record& record);
  /// Goes on after what the files of a resumed run and its record hold.
  void resume(const Record& record);

  std::vector<output::OutputSummary> summarise() const;

 private:
  void open_fields(const scene::OutputControl& control, const Simulation& simulation,
                   const std::filesystem::path& path, const output::Provenance& provenance,
                   output::Start start);
  void write_fields(Simulation& simulation);
  void write_profiles(Simulation& simulation);
  void open_item_streams(const scene::OutputControl& control, const Simulation& simulation,
                         const output::RunDirectory& directory,
                         const output::Provenance& provenance, output::Start start);
  void write_item_streams(const Simulation& simulation, bool last);

  const coupling::SurfaceFields& surface_;
  Schedule fields_schedule_, parcels_schedule_, profiles_schedule_, series_schedule_;
  Schedule spectra_schedule_, droplets_schedule_;
  std::vector<output::Variable> field_variables_, ground_variables_, profile_variables_;
  std::unique_ptr<output::FieldFile> fields_;
  std::unique_ptr<output::ParcelFile> parcels_;
  std::unique_ptr<output::ProfileFile> profiles_;
  std::unique_ptr<output::SeriesFile> series_;
  std::unique_ptr<SizeSpectra> size_spectra_;
  std::unique_ptr<output::RecordFile> spectra_;
  std::unique_ptr<output::ItemFile> droplets_;
  std::vector<std::vector<double>> values_;
  double field_time_ = -1, parcel_time_ = -1, profile_time_ = -1, spectra_time_ = -1,
         droplet_time_ = -1;
};

}  // namespace pileus::model

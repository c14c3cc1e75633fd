// Files that grow by one record per output: variables over (time, axes…) in netCDF-4 form.
//
// The file is opened, extended and closed at each append, so that readers may open it at any time,
// and each append reaches the file whole or not at all (StagedFile).
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "output/netcdf_form.hpp"
#include "output/start.hpp"

namespace pileus::output {

class RecordFile {
 public:
  /// `axes` from the slowest to the fastest varying. Nothing is written before the first append,
  /// except that `Start::resume_at` removes later records. Throws Error(ExitCode::file): a file of
  /// that name exists (`Start::fresh`), or it does not hold the same variables (`resume_at`).
  RecordFile(std::filesystem::path path, std::vector<Axis> axes, std::vector<Variable> variables,
             Provenance provenance, Encoding encoding, Start start);

  /// Adds one record: per variable, in the order given at construction, the values over the axes
  /// (fastest axis contiguous). `time` (s) has to be later than the last record.
  void append(double time, std::span<const std::vector<double>> values);

  /// Adds `times.size()` records at once; per variable the records one after another.
  void append_records(std::span<const double> times, std::span<const std::vector<double>> values);

  const std::filesystem::path& path() const { return path_; }
  const std::vector<Axis>& axes() const { return axes_; }
  const std::vector<Variable>& variables() const { return variables_; }
  const Encoding& encoding() const { return encoding_; }
  /// Times of the records in the file, s.
  const std::vector<double>& times() const { return times_; }
  /// Values per variable and record.
  std::size_t record_size() const;

 private:
  void resume(double time);
  void create(const hdf5::Session& session) const;
  VariableShape shape(std::vector<hid_t> scales) const;
  void extend(const hdf5::Session& session, std::span<const double> times,
              std::span<const std::vector<double>> values);

  std::filesystem::path path_;
  std::vector<Axis> axes_;
  std::vector<Variable> variables_;
  Provenance provenance_;
  Encoding encoding_;
  bool exists_ = false;
  std::vector<double> times_;
  std::vector<float> floats_;
  std::vector<double> doubles_;
};

}  // namespace pileus::output

// Files that grow by one record per output: variables over (time, axes…) in netCDF-4 form, all of
// them over the same axes but for those of a second set.
//
// The file is opened, extended and closed at each append, so that readers may open it at any time,
// and each append reaches the file whole or not at all (StagedFile).
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "output/netcdf_form.hpp"
#include "output/start.hpp"

namespace pileus::output {

class RecordFile {
 public:
  /// An axis of `second` of the name of one of `main` is that one. Nothing is written before
  /// the first append, except that `Start::resume_at` removes later records. Throws
  /// Error(ExitCode::file): a file of that name exists (`Start::fresh`), or it does not hold the
  /// same variables (`resume_at`).
  RecordFile(std::filesystem::path path, VariableSet main, VariableSet second,
             Provenance provenance, Encoding encoding, Start start);

  /// Adds one record: per variable, in the order given at construction and the main ones first, the
  /// values over the axes (fastest axis contiguous). `time` (s) has to be later than the last
  /// record.
  void append(double time, std::span<const std::vector<double>> values);

  /// Adds `times.size()` records at once; per variable the records one after another.
  void append_records(std::span<const double> times, std::span<const std::vector<double>> values);

  const std::filesystem::path& path() const { return path_; }
  /// Of the main variables.
  const std::vector<Axis>& axes() const { return sets_[0].axes; }
  const std::vector<Variable>& variables() const { return sets_[0].variables; }
  const Encoding& encoding() const { return encoding_; }
  /// Times of the records in the file, s.
  const std::vector<double>& times() const { return times_; }
  /// Values per main variable and record.
  std::size_t record_size() const { return sets_[0].record_size(); }

 private:
  void resume(double time);
  void resume(const hdf5::Session& session, const VariableSet& set) const;
  void create(const hdf5::Session& session) const;
  VariableShape shape(const VariableSet& set, std::vector<hid_t> scales) const;
  void extend(const hdf5::Session& session, std::span<const double> times,
              std::span<const std::vector<double>> values);
  void extend(const hdf5::Session& session, const VariableSet& set, std::size_t records,
              std::span<const std::vector<double>> values);

  std::filesystem::path path_;
  std::array<VariableSet, 2> sets_;
  Provenance provenance_;
  Encoding encoding_;
  bool exists_ = false;
  std::vector<double> times_;
  std::vector<float> floats_;
  std::vector<double> doubles_;
};

}  // namespace pileus::output

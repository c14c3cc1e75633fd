// The three kinds of record file a run writes.
#pragma once
#include <filesystem>
#include <span>
#include <vector>

#include "output/record_file.hpp"

namespace pileus::output {

/// Gridded fields over (time, z, y, x), in 2D (time, z, x), with an XDMF sidecar `<name>.xmf`.
/// `axes` and values as `node_axes` and `copy_nodes` give them. Quantities of the ground lie over
/// (time, y_cell, x_cell), in 2D (time, x_cell), with the axes of `ground_axes`; they are not in
/// the sidecar.
class FieldFile {
 public:
  FieldFile(std::filesystem::path path, std::vector<Axis> axes, std::vector<Variable> variables,
            Provenance provenance, Encoding encoding, Start start, VariableSet ground = {});

  /// See RecordFile::append.
  void append(double time, std::span<const std::vector<double>> values);
  const RecordFile& records() const { return records_; }

 private:
  void write_sidecar() const;
  RecordFile records_;
};

/// Horizontal means and the like over (time, z), exact. With `intervals` every record is of an
/// interval of time: after the variables' values, append() takes its start and its end (s).
class ProfileFile : public RecordFile {
 public:
  ProfileFile(std::filesystem::path path, Axis height, std::vector<Variable> variables,
              Provenance provenance, Start start, bool intervals = false);
};

/// Named numbers over time, exact.
class SeriesFile : public RecordFile {
 public:
  SeriesFile(std::filesystem::path path, std::vector<Variable> variables, Provenance provenance,
             Start start);
  /// One record: a number per variable.
  void append(double time, std::span<const double> values);
};

}  // namespace pileus::output

// Things over time as a CF contiguous ragged array, with an XDMF sidecar of their positions.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "output/netcdf_form.hpp"
#include "output/start.hpp"

namespace pileus::output {

/// What a ragged file holds of every thing, besides its position.
struct RaggedContent {
  std::string group;                // of the file, "parcels"
  std::string counted;              // "number of parcels of the record"
  std::vector<Variable> wholes;     // whole numbers of 64 bits
  std::vector<Variable> positions;  // coordinates, always written
  std::vector<Variable> columns;
};

/// The values of one record, in the order of the content.
struct RaggedRecord {
  std::size_t size = 0;
  std::vector<const std::uint64_t*> wholes;
  std::vector<const double*> positions, columns;
};

/// A group of an HDF5 file in netCDF-4 form: `time`, `row_size(time)`, the rest over `obs`. Record
/// k starts at the sum of the row sizes before it. Opened, extended and closed at each append,
/// whole or not at all. The sidecar `<name>.xmf` shows the points in ParaView.
class RaggedFile {
 public:
  /// Values are never compressed: the order of things leaves little to gain, and a rewritten
  /// compressed chunk would leave dead space behind. Throws Error(ExitCode::file) as RecordFile
  /// does.
  RaggedFile(std::filesystem::path path, RaggedContent content, Provenance provenance,
             Encoding encoding, Start start);

  /// Adds a record at `time` (s).
  void append(double time, const RaggedRecord& record);

  const std::filesystem::path& path() const { return path_; }
  const RaggedContent& content() const { return content_; }
  const std::vector<double>& times() const { return times_; }
  const std::vector<std::uint64_t>& row_sizes() const { return row_sizes_; }

 private:
  void resume(double time);
  void create(const hdf5::Session& session) const;
  void extend(const hdf5::Session& session, double time, const RaggedRecord& record);
  void write_sidecar() const;
  std::uint64_t total() const;

  std::filesystem::path path_;
  RaggedContent content_;
  Provenance provenance_;
  Encoding encoding_;
  bool exists_ = false;
  std::vector<double> times_;
  std::vector<std::uint64_t> row_sizes_;
  std::vector<float> floats_;
  std::vector<double> doubles_;
};

/// Position variables of things that are called `what`'s.
std::vector<Variable> position_variables(int dimension, const std::string& of_what);

}  // namespace pileus::output

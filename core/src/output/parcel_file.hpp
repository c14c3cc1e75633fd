// Parcels over time as a CF contiguous ragged array, with an XDMF sidecar.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "output/netcdf_form.hpp"
#include "output/start.hpp"
#include "parcels/store.hpp"

namespace pileus::output {

/// Group `/parcels` of an HDF5 file in netCDF-4 form: `time`, `row_size(time)` (the number of
/// parcels of each record), `uid(obs)`, the positions and the chosen columns over `obs`. Record k
/// starts at the sum of the row sizes before it. Opened, extended and closed at each append, whole
/// or not at all. The sidecar `<name>.xmf` shows the points in ParaView.
class ParcelFile {
 public:
  /// `columns` names columns of the store (Store::column_name) beside the positions, which are
  /// always written. Values are never compressed: the order of parcels leaves little to gain, and
  /// a rewritten compressed chunk would leave dead space behind. Throws Error(ExitCode::file) as
  /// RecordFile does.
  ParcelFile(std::filesystem::path path, int dimension, std::vector<Variable> columns,
             Provenance provenance, Encoding encoding, Start start);

  /// Adds all parcels of the store at `time` (s), in the store's order. Throws
  /// std::invalid_argument when the store lacks a column.
  void append(double time, const parcels::Store& store);

  const std::filesystem::path& path() const { return path_; }
  const std::vector<double>& times() const { return times_; }
  const std::vector<std::uint64_t>& row_sizes() const { return row_sizes_; }

 private:
  void resume(double time);
  void create(const hdf5::Session& session) const;
  void extend(const hdf5::Session& session, double time, const parcels::Store& store);
  void write_sidecar() const;
  std::uint64_t total() const;

  std::filesystem::path path_;
  std::vector<Variable> positions_, columns_;
  Provenance provenance_;
  Encoding encoding_;
  bool exists_ = false;
  std::vector<double> times_;
  std::vector<std::uint64_t> row_sizes_;
  std::vector<float> floats_;
  std::vector<double> doubles_;
};

}  // namespace pileus::output

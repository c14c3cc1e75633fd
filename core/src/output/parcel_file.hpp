// Parcels over time.
#pragma once
#include <filesystem>
#include <vector>

#include "output/ragged_file.hpp"
#include "parcels/store.hpp"

namespace pileus::output {

/// Group `/parcels`: `uid(obs)`, the positions and the chosen columns of all parcels.
class ParcelFile : private RaggedFile {
 public:
  /// `columns` names columns of the store (Store::column_name) beside the positions, which are
  /// always written.
  ParcelFile(std::filesystem::path path, int dimension, std::vector<Variable> columns,
             Provenance provenance, Encoding encoding, Start start);

  /// Adds all parcels of the store at `time` (s), in the store's order. Throws
  /// std::invalid_argument when the store lacks a column.
  void append(double time, const parcels::Store& store);

  using RaggedFile::path;
  using RaggedFile::row_sizes;
  using RaggedFile::times;
};

}  // namespace pileus::output

// Reading results back: variables with their axes, units and records.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "output/hdf5.hpp"

namespace pileus::output {

/// A variable of a results file.
struct StoredVariable {
  std::string name, units, long_name;
  std::vector<std::string> dimensions;  // slowest first, e.g. time, z, y, x
  std::vector<std::size_t> extent;      // entries along each of them
};

/// A results file in netCDF-4 form, open for reading. A run may go on writing to the file: what is
/// seen is the state at opening.
class ResultsFile {
 public:
  /// Throws Error(ExitCode::file) when the file is missing, no HDF5 file or truncated.
  explicit ResultsFile(const std::filesystem::path& path);

  const std::vector<StoredVariable>& variables() const { return variables_; }
  /// The variable of that name; nullptr when there is none.
  const StoredVariable* find(std::string_view name) const;

  /// All values of a variable, slowest dimension first.
  /// Throws Error(ExitCode::file): unknown name, or the values cannot be read.
  std::vector<double> read(std::string_view name) const;
  /// The values of a hyperslab: `start` and `count` have an entry for every dimension.
  std::vector<double> read(std::string_view name, std::span<const std::size_t> start,
                           std::span<const std::size_t> count) const;

 private:
  const StoredVariable& require(std::string_view name) const;

  hdf5::Session session_;
  std::vector<StoredVariable> variables_;
};

}  // namespace pileus::output

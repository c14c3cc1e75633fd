// Tables: columns of numbers and words over one dimension, in netCDF-4 form.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "output/netcdf_form.hpp"
#include "output/provenance.hpp"

namespace pileus::output {

struct NumberColumn {
  Variable variable;
  std::vector<double> values;  // NaN: missing
  bool whole = false;          // stored as 64-bit integers; none is missing
};

struct WordColumn {
  Variable variable;
  std::vector<std::string> values;
};

/// A variable for the values of a column, over the one axis of `shape`.
hdf5::Id create_column(const hdf5::Session& session, const NumberColumn& column,
                       const VariableShape& shape);

/// Writes a table whose rows are counted by a coordinate variable of that name, replacing a file
/// that is there. All columns have `rows` entries; names are valid variable names.
/// Throws Error(ExitCode::file).
void write_table(const std::filesystem::path& path, const std::string& dimension, std::size_t rows,
                 const std::vector<NumberColumn>& numbers, const std::vector<WordColumn>& words,
                 const Provenance& provenance);

}  // namespace pileus::output

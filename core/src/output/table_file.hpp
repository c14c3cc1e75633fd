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
};

struct WordColumn {
  Variable variable;
  std::vector<std::string> values;
};

/// Writes a table whose rows are counted by a coordinate variable of that name, replacing a file
/// that is there. All columns have `rows` entries; names are valid variable names.
/// Throws Error(ExitCode::file).
void write_table(const std::filesystem::path& path, const std::string& dimension, std::size_t rows,
                 const std::vector<NumberColumn>& numbers, const std::vector<WordColumn>& words,
                 const Provenance& provenance);

}  // namespace pileus::output

// An ensemble in one file: variables over its members, their parameters, and statistics.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "output/netcdf_form.hpp"
#include "output/provenance.hpp"
#include "output/table_file.hpp"

namespace pileus::output {

/// A variable over the members and some axes.
struct MemberVariable {
  Variable variable;
  std::vector<std::string> axes;  // slowest first, without the members
  std::vector<double> values;     // members × axes; NaN: missing
  /// Per member the file that holds its values as `source_name`, relative to the ensemble's, empty
  /// for none. They are then referred to (HDF5 virtual dataset). Without any entry, `values` are
  /// written.
  std::vector<std::string> sources{};
  std::string source_name{};
};

/// A statistic of the members over some axes.
struct StatisticVariable {
  Variable variable;
  std::vector<std::string> axes;
  std::vector<double> values;
  std::string cell_methods;  // CF, "member: mean"; empty: CF has no word for it
};

struct EnsembleContent {
  std::size_t members = 0;
  std::string sweep;                  // the file that describes it, kept as a text variable
  std::vector<Axis> axes;             // besides the members
  std::vector<NumberColumn> numbers;  // parameters, a value per member …
  std::vector<WordColumn> words;      // … and those that are words; coordinates, both
  std::vector<MemberVariable> variables;
  std::vector<StatisticVariable> statistics;
};

/// Writes the dimension `member`, counted from 0, and everything over it, replacing a file that is
/// there. Numbers are exact. Names are valid variable names and differ. Throws Error(file).
void write_ensemble(const std::filesystem::path& path, const EnsembleContent& content,
                    const Provenance& provenance);

}  // namespace pileus::output

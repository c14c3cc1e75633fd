// What a sweep's members leave together: ensemble.nc, members.csv and pictures of the spread.
#pragma once
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "output/netcdf_form.hpp"
#include "study/sweep_run.hpp"

namespace pileus::study {

/// A file that every member has, such as series.nc, over common times and heights.
struct CollectedStream {
  std::string file;                // of a member, relative to its folder
  std::string prefix;              // of names in the ensemble
  std::vector<output::Axis> axes;  // that of times first
  std::vector<output::Variable> variables;
  std::vector<std::vector<double>> values;  // per variable: members × axes, NaN: missing
  std::vector<std::vector<bool>> present;   // per variable: whether the member has it
  bool as_stored = true;                    // times and heights are those of every member

  std::size_t record_size() const;
};

/// Reads a file of all members that are done; nothing when none has it with a record in it.
/// `prefix`: of the names of its times and variables in the ensemble; `every`: the interval of its
/// records, s. Throws Error(file).
std::optional<CollectedStream> collect_stream(const SweepResult& result, const std::string& file,
                                              const std::string& prefix, double every);

/// Writes members.csv, ensemble.nc of the members that are done, and the pictures, and says so.
/// Throws Error(file).
void collect(const SweepRequest& request, const SweepResult& result, std::ostream& out);

}  // namespace pileus::study

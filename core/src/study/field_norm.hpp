// How far a gridded field is from a finer run's.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "study/study_file.hpp"

namespace pileus::study {

/// The last record of a gridded field with its nodes.
struct GriddedField {
  /// Nodes along z, (y,) x; all but the first axis are periodic with these lengths.
  std::vector<std::vector<double>> axes;
  std::vector<double> period;  // per axis; 0 for z
  std::vector<double> values;  // slowest axis first
};

/// Reads the field from the fields.nc of a run's folder. Throws Error(file).
GriddedField read_field(const std::filesystem::path& folder, const std::string& name);

/// Values of a field at the nodes of another, by linear interpolation along every axis, which is
/// how the model reads its mesh; exact where the nodes coincide.
std::vector<double> values_at(const GriddedField& field, const GriddedField& nodes);

/// R.m.s. difference over the nodes of `field` (boundary levels count half) divided by the r.m.s.
/// deviation of `finest` from its mean, or by one where that is zero.
double field_error(const GriddedField& field, const GriddedField& finest);

/// R.m.s. difference of the volume-weighted histograms of two fields over the r.m.s. of `finest`'s.
/// Values beyond the range count in the outermost bins.
double histogram_error(const GriddedField& field, const GriddedField& finest,
                       const ErrorNorm& norm);

}  // namespace pileus::study

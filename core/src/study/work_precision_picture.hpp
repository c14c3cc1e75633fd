// Work-precision diagrams: error against cost, and error against every knob.
#pragma once
#include <string>

#include "study/picture.hpp"
#include "study/work_precision.hpp"

namespace pileus::study {

/// The picture of one norm, as a gnuplot script without `set terminal` and `set output`: error
/// against cost with the Pareto front, then one panel per knob that has numbers with guide slopes;
/// all axes logarithmic, the range over the seeds as bars, published results beside.
std::string work_precision_script(const Findings& findings, std::size_t norm);
PictureSize work_precision_size(const Findings& findings);

}  // namespace pileus::study

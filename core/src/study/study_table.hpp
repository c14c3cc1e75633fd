// A study's findings as a table for a terminal.
#pragma once
#include <string>
#include <vector>

#include "study/work_precision.hpp"

namespace pileus::study {

/// Rows by curve, the errors with local orders and the Pareto front marked, published results,
/// orders along every knob, what failed, and the bounds kept and missed.
std::string findings_table(const Findings& findings, const std::vector<Verdict>& verdicts);

}  // namespace pileus::study

// The lists of a sweep's members: sweep.json and members.tsv while it goes on, members.csv of what
// came out.
#pragma once
#include "study/sweep_run.hpp"

namespace pileus::study {

/// Writes sweep.json and members.tsv: index, settings, seed, status, hash and wall time.
void write_member_lists(const SweepResult& result);

/// Writes members.csv: the parameters of every member against the final, mean, smallest and largest
/// value of each of its diagnostics.
void write_member_table(const SweepResult& result);

}  // namespace pileus::study

// The experiment on shape integrators: errors and cost of ways to deform parcels in a given random
// strain.
#pragma once
#include <string>
#include <vector>

#include "study/outcome.hpp"
#include "study/points.hpp"

namespace pileus::study {

/// What its knobs may be: `integrator` (one of these words) and `alpha`.
const std::vector<std::string>& shape_integrator_names();

/// Reports knobs that the experiment does not have, and values they cannot take.
void check_shape_knobs(const Study& study, const Layout& layout, scene::Problems& problems);

/// Deforms 1024 random shapes (positive definite, det B = 1) over 3.2 times the inverse of the
/// worst-case strain (the largest eigenvalue of the symmetric part that either end has), in steps
/// of `alpha` in that unit; the gradient is traceless, random and linear in time. Numbers:
///   shape_error         r.m.s. relative Frobenius error of B
///   determinant_error   r.m.s. error of det B
///   broken_shapes       how many are no longer positive definite
/// The reference is the exponential form of order 4 in 1024 steps, sixteen times as many as the
/// finest alpha of 0.05 takes: its own error is 16⁻⁴ of what is compared with it.
/// The cost, in both times, is ns per shape for the whole way; best of many passes.
RunOutcome run_shape_experiment(const Layout& layout, const Point& point);

}  // namespace pileus::study

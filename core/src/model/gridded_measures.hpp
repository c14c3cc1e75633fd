// Numbers taken from one gridded field: the amplitude of a mode, where a front is, how far the
// field is from its mirror image.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "model/simulation.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// A gridded field with its nodes: values in file order, z slowest and x fastest. The field is
/// periodic in x and y, so that the node at the upper end of x is the first one again.
struct NodeField {
  std::vector<double> x, y, z;  // m; y has one entry in two dimensions
  double period = 0;            // m, of x
  std::vector<double> values;

  double at(std::size_t i, std::size_t j, std::size_t k) const {
    return values[(k * y.size() + j) * x.size() + i];
  }
  double centre() const { return x.front() + 0.5 * period; }
};

/// The nodes of a simulation, without values.
NodeField nodes_of(const Simulation& simulation);

/// Part of a field with a given shape: the a and b of least squares in
/// f = a cosine(x, y, z) + b sine(x, y, z), walls at half weight as in the trapezoidal rule.
class Mode {
 public:
  Mode(const scene::ModeControl& control, const scene::Scene& scene, const NodeField& nodes);

  const std::string& variable() const { return variable_; }
  std::vector<std::array<std::string, 3>> outputs() const;
  /// Amplitude √(a² + b²) and, with a sine, the phase atan2(b, a), which grows as σt where
  /// f ∝ cos(kx − σt).
  std::vector<double> measure(const NodeField& field) const;

 private:
  std::string name_, variable_;
  std::vector<double> cosine_, sine_;  // weighted shapes; sine_ empty: none
  double cc_ = 0, cs_ = 0, ss_ = 0;    // their products with the unweighted ones
};

/// Largest distance in x from the domain's centre at which a field is beyond a threshold at one
/// height, linear between nodes and levels; 0 where it is nowhere.
double front_position(const NodeField& field, const scene::FrontControl& front);

/// Largest |f(x) − f(mirrored x)| (even) or |f(x) + f(mirrored x)| (odd) over the largest |f|,
/// mirrored at the domain's centre in x; 0 for a field of zeros.
double asymmetry(const NodeField& field, bool odd);

}  // namespace pileus::model

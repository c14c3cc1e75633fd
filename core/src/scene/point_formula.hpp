// A formula of a scene together with the named formulas it uses, evaluated at a point.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "scene/formula.hpp"
#include "scene/scene.hpp"

namespace pileus::scene {

/// The names a formula may use beside its coordinates.
struct Vocabulary {
  std::map<std::string, double> constants;
  std::vector<NamedFormula> formulas;
};

/// Evaluating changes the object: one copy per thread, made by one thread.
class PointFormula {
 public:
  /// `coordinates` begin with x, y and z, which named formulas are made of. Throws FormulaProblem.
  PointFormula(const std::string& text, std::vector<std::string> coordinates,
               const Vocabulary& vocabulary);

  /// Its value; each named formula that is needed is evaluated once.
  double operator()(const double* coordinates);

  /// Whether the coordinate of this index has any part in the value.
  bool uses(std::size_t coordinate) const;

 private:
  std::size_t coordinates_;
  std::vector<Formula> formulas_;  // the named ones, then the formula itself
  std::vector<double> values_;     // of coordinates and named formulas
  std::vector<bool> needed_;       // per formula
};

}  // namespace pileus::scene

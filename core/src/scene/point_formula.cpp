#include "scene/point_formula.hpp"

#include <algorithm>

namespace pileus::scene {

PointFormula::PointFormula(const std::string& text, std::vector<std::string> coordinates,
                           const Vocabulary& vocabulary)
    : coordinates_(coordinates.size()) {
  std::vector<std::string> variables = std::move(coordinates);
  for (const NamedFormula& named : vocabulary.formulas) {
    formulas_.emplace_back(named.text, variables, vocabulary.constants);
    variables.push_back(named.name);
  }
  formulas_.emplace_back(text, variables, vocabulary.constants);
  values_.assign(variables.size(), 0.0);
  needed_.assign(formulas_.size(), false);
  needed_.back() = true;
  // From the end backwards, since a formula uses only those before it.
  for (std::size_t i = formulas_.size(); i-- > 0;)
    for (std::size_t j = 0; needed_[i] && j < i; ++j)
      if (formulas_[i].uses(coordinates_ + j)) needed_[j] = true;
}

double PointFormula::operator()(const double* coordinates) {
  std::copy_n(coordinates, coordinates_, values_.data());
  const std::size_t last = formulas_.size() - 1;
  for (std::size_t i = 0; i < last; ++i)
    if (needed_[i]) values_[coordinates_ + i] = formulas_[i](values_.data());
  return formulas_[last](values_.data());
}

bool PointFormula::uses(std::size_t coordinate) const {
  for (std::size_t i = 0; i < formulas_.size(); ++i)
    if (needed_[i] && formulas_[i].uses(coordinate)) return true;
  return false;
}

}  // namespace pileus::scene

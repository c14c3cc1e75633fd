#include "study/duration_model.hpp"

#include <algorithm>
#include <cmath>

namespace pileus::study {

namespace {

/// Strength of the prior that a knob costs nothing, in units of one run a factor e away.
constexpr double ridge = 0.01;

/// Solves the symmetric positive definite system in place (Cholesky).
std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    a[j][j] = std::sqrt(a[j][j]);
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return b;
}

}  // namespace

void DurationModel::learn(const std::vector<double>& position, double seconds) {
  positions_.push_back(position);
  logarithms_.push_back(std::log(std::max(seconds, 1e-3)));
  fit();
}

void DurationModel::fit() {
  const auto n = static_cast<double>(positions_.size());
  centre_.assign(knobs_, 0.0);
  mean_ = 0;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    mean_ += logarithms_[i] / n;
    for (std::size_t k = 0; k < knobs_; ++k) centre_[k] += positions_[i][k] / n;
  }
  std::vector<std::vector<double>> normal(knobs_, std::vector<double>(knobs_, 0.0));
  std::vector<double> right(knobs_, 0.0);
  for (std::size_t k = 0; k < knobs_; ++k) normal[k][k] = ridge;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    for (std::size_t k = 0; k < knobs_; ++k) {
      const double x = positions_[i][k] - centre_[k];
      right[k] += x * (logarithms_[i] - mean_);
      for (std::size_t l = 0; l < knobs_; ++l) normal[k][l] += x * (positions_[i][l] - centre_[l]);
    }
  }
  slopes_ = solve(std::move(normal), std::move(right));
}

std::optional<double> DurationModel::predict(const std::vector<double>& position) const {
  if (positions_.empty()) return std::nullopt;
  double logarithm = mean_;
  for (std::size_t k = 0; k < knobs_; ++k) logarithm += slopes_[k] * (position[k] - centre_[k]);
  return std::exp(logarithm);
}

}  // namespace pileus::study

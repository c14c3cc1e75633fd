#include "mesh/vertical_basis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"

namespace pileus::mesh {

namespace {

constexpr std::size_t tables_per_wavenumber = 7;
// The same K² computed from different (k, l) differs by rounding only.
constexpr double same_wavenumber = 1e-12;

/// sin(πj/n) and cos(πj/n) with the argument reduced exactly.
double sine(long j, int n) {
  return std::sin(std::numbers::pi * double(j % (2L * n)) / n);
}
double cosine(long j, int n) {
  return std::cos(std::numbers::pi * double(j % (2L * n)) / n);
}

}  // namespace

double hou_li_factor(double fraction) {
  return std::exp(-36 * std::pow(std::abs(fraction), 36));
}

VerticalBasis::VerticalBasis(int nz, double height, const std::vector<double>& squared_wavenumbers)
    : nz_(nz), squared_(squared_wavenumbers) {
  std::sort(squared_.begin(), squared_.end());
  const auto same = [](double a, double b) { return b - a <= same_wavenumber * b; };
  squared_.erase(std::unique(squared_.begin(), squared_.end(), same), squared_.end());

  const auto interior = [nz](int k) { return k > 0 && k < nz; };
  sine_synthesis_ = ColumnMatrix(
      nz, [&](int k, int m) { return interior(k) && interior(m) ? sine(long(k) * m, nz) : 0; });
  sine_analysis_ = ColumnMatrix(nz, [&](int m, int k) {
    return interior(k) && interior(m) ? 2.0 / nz * sine(long(k) * m, nz) : 0;
  });
  cosine_synthesis_ =
      ColumnMatrix(nz, [&](int k, int m) { return interior(m) ? cosine(long(k) * m, nz) : 0; });

  for (AlignedArray<double>* column : {&wavenumber_, &filter_, &mean_lower_, &mean_upper_,
                                       &mean_lower_integral_, &mean_upper_integral_}) {
    column->discard_and_resize(pitch());
    column->fill(0);
  }
  tabulate_mean(height);
  tables_.discard_and_resize(squared_.size() * tables_per_wavenumber * pitch());
  tables_.fill(0);
  for (std::size_t index = 0; index < squared_.size(); ++index) tabulate(index, height);
}

void VerticalBasis::tabulate_mean(double height) {
  for (int k = 0; k <= nz_; ++k) {
    const auto at = std::size_t(k);
    wavenumber_[at] = std::numbers::pi * k / height;
    filter_[at] = hou_li_factor(double(k) / nz_);
    const double upper = double(k) / nz_, lower = double(nz_ - k) / nz_;
    mean_lower_[at] = lower;
    mean_upper_[at] = upper;
    mean_upper_integral_[at] = height / 2 * (upper * upper - 1.0 / 3);
    mean_lower_integral_[at] = -height / 2 * (lower * lower - 1.0 / 3);
  }
}

void VerticalBasis::tabulate(std::size_t index, double height) {
  double* table = tables_.data() + index * tables_per_wavenumber * pitch();
  // The particular solutions θ are differences of terms (K L)⁻² times larger than themselves:
  // extended precision keeps them accurate in domains much wider than they are tall.
  using Real = long double;
  const Real wavenumber = std::sqrt(Real(squared_[index])), kl = wavenumber * Real(height);
  const Real decay = std::exp(-kl), d = -1 / std::expm1(-2 * kl);
  const Real coth = d * (1 + decay * decay), csch = 2 * d * decay;
  const Real scale = 1 / (2 * wavenumber * wavenumber);
  for (int k = 0; k <= nz_; ++k) {
    const auto at = std::size_t(k);
    const Real below = kl * k / nz_, above = kl * (nz_ - k) / nz_;  // K(z − z0), K(z1 − z)
    const Real e_below = std::exp(-below), e_above = std::exp(-above);
    const Real lower = -d * e_below * std::expm1(-2 * above);
    const Real upper = -d * e_above * std::expm1(-2 * below);
    const Real lower_z = -wavenumber * d * (e_below + decay * e_above);
    const Real upper_z = wavenumber * d * (e_above + decay * e_below);
    const Real inverse[] = {
        lower,
        upper,
        scale * (csch * above * upper - coth * below * lower),
        scale * (csch * below * lower - coth * above * upper),
        -scale * ((coth * below - 1) * lower_z - csch * above * upper_z),
        -scale * ((coth * above - 1) * upper_z - csch * below * lower_z),
        k == 0 || k == nz_
            ? 0
            : -1 / (wavenumber * wavenumber + Real(wavenumber_[at]) * Real(wavenumber_[at]))};
    for (std::size_t t = 0; t < tables_per_wavenumber; ++t)
      table[t * pitch() + at] = double(inverse[t]);
  }
}

int VerticalBasis::find(double squared_wavenumber) const {
  const auto it = std::lower_bound(squared_.begin(), squared_.end(),
                                   squared_wavenumber * (1 - 2 * same_wavenumber));
  if (it == squared_.end() || std::abs(*it - squared_wavenumber) > 4 * same_wavenumber * *it)
    throw Error(ExitCode::numerical, "A wavenumber is missing from the vertical basis.");
  return int(it - squared_.begin());
}

EndFunctions VerticalBasis::end_functions(int index) const {
  const double* table = tables_.data() + std::size_t(index) * tables_per_wavenumber * pitch();
  const std::size_t p = pitch();
  return {table,         table + p,     table + 2 * p, table + 3 * p,
          table + 4 * p, table + 5 * p, table + 6 * p};
}

std::size_t VerticalBasis::allocated_bytes() const {
  return tables_.allocated_bytes();
}

}  // namespace pileus::mesh

#include "mesh/vertical_derivative.hpp"

#include <Eigen/Dense>

namespace pileus::mesh {

namespace {

Eigen::MatrixXd centred_matrix(int nz) {
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(nz + 1, nz + 1);
  for (int k = 1; k < nz; ++k) {
    d(k, k - 1) = -0.5;
    d(k, k + 1) = 0.5;
  }
  d(0, 0) = -1;
  d(0, 1) = 1;
  d(nz, nz - 1) = -1;
  d(nz, nz) = 1;
  return d;
}

Eigen::MatrixXd parabola_matrix() {
  Eigen::MatrixXd d(3, 3);
  d << -1.5, 2, -0.5, -0.5, 0, 0.5, 0.5, -2, 1.5;
  return d;
}

Eigen::MatrixXd compact_matrix(int nz) {
  Eigen::MatrixXd left = Eigen::MatrixXd::Zero(nz + 1, nz + 1), right = left;
  for (int k = 1; k < nz; ++k) {
    left(k, k - 1) = left(k, k + 1) = 1;
    left(k, k) = 4;
    right(k, k + 1) = 3;
    right(k, k - 1) = -3;
  }
  left(0, 0) = left(nz, nz) = 1;
  left(0, 1) = left(nz, nz - 1) = 2;
  right(0, 0) = -2.5;
  right(0, 1) = 2;
  right(0, 2) = 0.5;
  right(nz, nz) = 2.5;
  right(nz, nz - 1) = -2;
  right(nz, nz - 2) = -0.5;
  return left.partialPivLu().solve(right);
}

Eigen::MatrixXd unit_spacing_matrix(VerticalDerivative kind, int nz) {
  if (kind == VerticalDerivative::centred || nz == 1) return centred_matrix(nz);
  return nz == 2 ? parabola_matrix() : compact_matrix(nz);
}

}  // namespace

ColumnMatrix vertical_derivative(VerticalDerivative kind, int nz, double spacing) {
  const Eigen::MatrixXd d = unit_spacing_matrix(kind, nz);
  return ColumnMatrix(nz, [&](int row, int column) { return d(row, column) / spacing; });
}

std::vector<double> derivative_quadrature(VerticalDerivative kind, int nz) {
  std::vector<double> q(std::size_t(nz) + 1, 1.0);
  if (kind == VerticalDerivative::centred || nz == 1) {
    q.front() = q.back() = 0.5;
    return q;
  }
  if (nz == 2) return {1.0 / 3, 4.0 / 3, 1.0 / 3};
  // The rows of the compact system, scaled to sum to one on the left, telescope when the two rows
  // next to each wall count 3/4 and all others 1; the weights are the column sums of the left side.
  std::fill(q.begin(), q.end(), 0.0);
  const auto row_weight = [&](int k) { return k < 2 || k > nz - 2 ? 0.75 : 1.0; };
  for (int k = 0; k <= nz; ++k) {
    const double v = row_weight(k);
    if (k == 0 || k == nz) {
      q[std::size_t(k)] += v / 3;
      q[std::size_t(k == 0 ? 1 : nz - 1)] += 2 * v / 3;
    } else {
      q[std::size_t(k - 1)] += v / 6;
      q[std::size_t(k)] += 4 * v / 6;
      q[std::size_t(k + 1)] += v / 6;
    }
  }
  return q;
}

}  // namespace pileus::mesh

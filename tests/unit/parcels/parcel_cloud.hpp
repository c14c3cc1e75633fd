// What the tests of the parcels share: random shapes and clouds, and a deposit written plainly.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "mesh/grid.hpp"
#include "parcels/store.hpp"

namespace pileus::testing {

using Random = std::mt19937_64;
inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// A rotation (or reflection) drawn evenly: Q of the QR decomposition of a Gaussian matrix.
template <int D>
Eigen::Matrix<double, D, D> random_rotation(Random& random) {
  std::normal_distribution<double> normal;
  Eigen::Matrix<double, D, D> m;
  for (int i = 0; i < D * D; ++i) m(i / D, i % D) = normal(random);
  return Eigen::HouseholderQR<Eigen::Matrix<double, D, D>>(m).householderQ();
}

/// Shape matrix with the given squared semi-axes in a random orientation.
template <int D>
Eigen::Matrix<double, D, D> random_shape(Random& random,
                                         const Eigen::Matrix<double, D, 1>& squared_axes) {
  const Eigen::Matrix<double, D, D> q = random_rotation<D>(random);
  const Eigen::Matrix<double, D, D> b = q * squared_axes.asDiagonal() * q.transpose();
  return 0.5 * (b + b.transpose());
}

template <int D>
void put_shape(parcels::Store& store, std::size_t p, const Eigen::Matrix<double, D, D>& b) {
  int c = 0;
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j, ++c) store.shape(c)[p] = b(i, j);
}
template <int D>
Eigen::Matrix<double, D, D> get_shape(const parcels::Store& store, std::size_t p) {
  Eigen::Matrix<double, D, D> b;
  int c = 0;
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j, ++c) b(i, j) = b(j, i) = store.shape(c)[p];
  return b;
}
template <int D>
Eigen::Matrix<double, D, 1> get_position(const parcels::Store& store, std::size_t p) {
  Eigen::Matrix<double, D, 1> x;
  for (int d = 0; d < D; ++d) x(d) = store.position(d)[p];
  return x;
}

/// (abc)² of an ellipsoid, (ab)² of an ellipse enclosing `volume`.
template <int D>
double squared_axes_product(double volume) {
  const double product = volume * (D == 3 ? 0.75 : 1.0) / std::numbers::pi;
  return product * product;
}
/// A shape that encloses `volume`, its squared axes up to `spread` times longer or shorter than the
/// sphere's before rescaling.
template <int D>
Eigen::Matrix<double, D, D> random_shape_of_volume(Random& random, double volume, double spread) {
  Eigen::Matrix<double, D, 1> squared_axes;
  for (int d = 0; d < D; ++d)
    squared_axes(d) = std::exp(uniform(random, -std::log(spread), std::log(spread)));
  squared_axes *= std::pow(squared_axes_product<D>(volume) / squared_axes.prod(), 1.0 / D);
  return random_shape<D>(random, squared_axes);
}

/// `count` elongated parcels of random volumes around `mean_volume` anywhere in the domain, the
/// attributes of order one, identities 1, 2, …
template <int D>
void fill_randomly(parcels::Store& store, const mesh::Grid<D>& grid, std::size_t count,
                   double mean_volume, double spread, Random& random) {
  store.resize(count);
  for (std::size_t p = 0; p < count; ++p) {
    for (int d = 0; d < D; ++d)
      store.position(d)[p] = uniform(random, grid.lower[d], grid.lower[d] + grid.extent[d]);
    store.volume()[p] = mean_volume * uniform(random, 0.2, 1.8);
    put_shape<D>(store, p, random_shape_of_volume<D>(random, store.volume()[p], spread));
    for (int c = 0; c < store.vorticity_components(); ++c)
      store.vorticity(c)[p] = uniform(random, -1, 1);
    for (std::size_t s = 0; s < store.scalars().size(); ++s)
      store.scalar(static_cast<int>(s))[p] = uniform(random, -1, 1);
    store.uid()[p] = p + 1;
  }
}

/// Support points (not offsets) of one parcel from Eigen's eigenvectors.
/// Reference: Frey, Dritschel and Böing 2022 (2D) and 2023 (3D).
template <int D>
std::vector<Eigen::Matrix<double, D, 1>> support_points(const parcels::Store& store,
                                                        std::size_t p) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, D, D>> solver(get_shape<D>(store, p));
  const auto& values = solver.eigenvalues();  // ascending
  const auto& vectors = solver.eigenvectors();
  const Eigen::Matrix<double, D, 1> x = get_position<D>(store, p);
  std::vector<Eigen::Matrix<double, D, 1>> points;
  if constexpr (D == 2) {
    const Eigen::Vector2d f = 0.5 * std::sqrt(values(1) - values(0)) * vectors.col(1);
    points = {x + f, x - f};
  } else {
    const Eigen::Vector3d eta = std::sqrt(0.4 * (values(2) - values(0))) * vectors.col(2);
    const Eigen::Vector3d tau = std::sqrt(0.4 * (values(1) - values(0))) * vectors.col(1);
    for (int j = 0; j < 4; ++j) {
      const double theta = (2 * j + 1) * std::numbers::pi / 4;
      points.push_back(x + std::cos(theta) * eta + std::sin(theta) * tau);
    }
  }
  return points;
}

/// Node indices and linear weights around a point: periodic horizontally, held within one halo
/// level of the walls vertically.
template <int D>
std::vector<std::pair<std::size_t, double>> weights_around(const mesh::Grid<D>& grid,
                                                           const Eigen::Matrix<double, D, 1>& x) {
  int low[3] = {0, 0, 0};
  double fraction[3] = {0, 0, 0};
  for (int d = 0; d < D; ++d) {
    double xi = (x(d) - grid.lower[d]) / grid.spacing[d];
    if (d == D - 1) {
      xi = std::min(std::max(xi, -1.0), grid.nz() + 1.0);
      low[2] = std::min(static_cast<int>(std::floor(xi)), grid.nz());
      fraction[2] = xi - low[2];
    } else {
      const double floor = std::floor(xi);
      fraction[d] = xi - floor;
      const int n = grid.cells[d];
      low[d] = static_cast<int>(std::fmod(std::fmod(floor, n) + n, n));
    }
  }
  std::vector<std::pair<std::size_t, double>> result;
  for (int b = 0; b < (D == 3 ? 8 : 4); ++b) {
    const int di = b & 1, dk = b >> 1 & 1, dj = D == 3 ? b >> 2 & 1 : 0;
    const int i = (low[0] + di) % grid.nx(), j = (low[1] + dj) % grid.ny();
    double w = (di ? fraction[0] : 1 - fraction[0]) * (dk ? fraction[2] : 1 - fraction[2]);
    if constexpr (D == 3) w *= dj ? fraction[1] : 1 - fraction[1];
    result.emplace_back(grid.node(grid.column(i, j), low[2] + dk), w);
  }
  return result;
}

/// The deposit as method and nothing else: volume and volume-weighted means, walls folded.
template <int D>
std::vector<double> plain_deposit(const mesh::Grid<D>& grid, const parcels::Store& store,
                                  const std::vector<const double*>& values) {
  constexpr int width = mesh::DepositRecord<D>::width;
  std::vector<double> field(grid.nodes() * width, 0.0);
  for (std::size_t p = 0; p < store.size(); ++p) {
    const auto points = support_points<D>(store, p);
    for (const auto& x : points)
      for (const auto& [node, w] : weights_around<D>(grid, x)) {
        const double share = w * store.volume()[p] / static_cast<double>(points.size());
        field[node * width] += share;
        for (std::size_t f = 0; f < values.size(); ++f)
          field[node * width + 1 + f] += share * values[f][p];
      }
  }
  const int nz = grid.nz();
  for (std::size_t c = 0; c < grid.columns(); ++c) {
    // Mirror images of what lies beyond a wall, of weight two on a wall (half cells).
    std::vector<double> folded(static_cast<std::size_t>(nz + 1) * width, 0.0);
    for (int k = -1; k <= nz + 1; ++k) {
      const int inside = k < 0 ? -k : k > nz ? 2 * nz - k : k;
      const double factor = inside == 0 || inside == nz ? 2 : 1;
      for (int f = 0; f < width; ++f)
        folded[static_cast<std::size_t>(inside) * width + f] +=
            factor * field[grid.node(c, k) * width + f];
    }
    for (int k = 0; k <= nz; ++k)
      for (int f = 0; f < width; ++f) {
        const double* node = &folded[static_cast<std::size_t>(k) * width];
        field[grid.node(c, k) * width + f] = f == 0 || node[0] == 0 ? node[f] : node[f] / node[0];
      }
  }
  return field;
}

/// Σ c_g V_g f_g over the levels 0 … n_z with c = ½ on the walls; f = −1: of the volume alone.
template <int D>
double mesh_sum(const mesh::Grid<D>& grid, const double* field, int width, int f) {
  long double sum = 0;
  for (std::size_t c = 0; c < grid.columns(); ++c)
    for (int k = 0; k <= grid.nz(); ++k) {
      const double* node = field + grid.node(c, k) * static_cast<std::size_t>(width);
      sum += (k == 0 || k == grid.nz() ? 0.5L : 1.0L) * node[0] * (f < 0 ? 1.0 : node[f]);
    }
  return static_cast<double>(sum);
}

}  // namespace pileus::testing

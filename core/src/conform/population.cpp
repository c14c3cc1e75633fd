// The random parcels of a small world.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "conform/world.hpp"

namespace pileus::conform {
namespace {

/// A shape of the parcel's size volume, its axes up to twice as long or short as the sphere's.
void draw_shape_2d(parcels::Store& store, std::size_t p, Random& random) {
  const double radius_2 = store.size_volume()[p] / std::numbers::pi;
  const double ratio = std::exp2(uniform(random, -1, 1)), angle = uniform(random, 0, 6.283);
  const double a = radius_2 * ratio, b = radius_2 / ratio, c = std::cos(angle), s = std::sin(angle);
  store.shape(0)[p] = a * c * c + b * s * s;
  store.shape(1)[p] = (a - b) * c * s;
  store.shape(2)[p] = a * s * s + b * c * c;
}

/// A rotation from a random quaternion.
std::array<std::array<double, 3>, 3> draw_rotation(Random& random) {
  std::array<double, 4> q{};
  double norm = 0;
  while (norm < 0.01) {
    norm = 0;
    for (double& x : q) {
      x = uniform(random, -1, 1);
      norm += x * x;
    }
  }
  for (double& x : q) x /= std::sqrt(norm);
  const auto [w, x, y, z] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

void draw_shape_3d(parcels::Store& store, std::size_t p, Random& random) {
  const double radius_2 = std::pow(0.75 * store.size_volume()[p] / std::numbers::pi, 2.0 / 3.0);
  const double s = std::exp2(uniform(random, -1, 1)), t = std::exp2(uniform(random, -1, 1));
  const std::array<double, 3> axes = {radius_2 * s, radius_2 * t, radius_2 / (s * t)};
  const auto q = draw_rotation(random);
  int c = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j, ++c) {
      double b = 0;
      for (std::size_t k = 0; k < 3; ++k) b += q[i][k] * axes[k] * q[j][k];
      store.shape(c)[p] = b;
    }
}

double draw_scalar(Random& random, const parcels::Scalar& scalar, bool corner) {
  const Range declared{scalar.low, scalar.high};
  if (corner) return draw_corner(random, widest_range(declared, scalar.units, false));
  return draw_between(random,
                      typical_range(declared, scalar.units, false, scalar.budget == "water"));
}

/// Quantities of one budget share what the parcel holds: together they are at most what one alone
/// may be, less what a sum of them may be rounded by.
void share_budgets(parcels::Store& store, std::size_t p) {
  std::map<std::string, Range> held;  // the sum, and the most
  for (std::size_t s = 0; s < store.scalars().size(); ++s) {
    const parcels::Scalar& scalar = store.scalars()[s];
    if (scalar.budget.empty() || scalar.nature != parcels::Nature::intensive) continue;
    Range& sum = held[scalar.budget];
    sum.low += store.scalar(static_cast<int>(s))[p];
    sum.high = std::max(sum.high, scalar.high);
  }
  for (std::size_t s = 0; s < store.scalars().size(); ++s) {
    const parcels::Scalar& scalar = store.scalars()[s];
    const auto sum = held.find(scalar.budget);
    if (sum == held.end() || scalar.nature != parcels::Nature::intensive) continue;
    double& value = store.scalar(static_cast<int>(s))[p];
    if (sum->second.low >= sum->second.high)
      value = std::max(scalar.low, value * (sum->second.high / sum->second.low) * (1 - 1e-9));
  }
}

}  // namespace

template <int D>
void draw_population(parcels::Store& store, const mesh::Grid<D>& grid, Random& random,
                     bool corners) {
  store.resize(population);
  const double mean_volume = grid.domain_volume() / static_cast<double>(population);
  for (std::size_t p = 0; p < population; ++p) {
    store.uid()[p] = mix_bits(random() + p) | 1u;
    store.volume()[p] = mean_volume * uniform(random, 0.2, 1.8);
    for (int d = 0; d < D; ++d)
      store.position(d)[p] = uniform(random, grid.lower[d], grid.lower[d] + grid.extent[d]);
    if (p % 64 == 0) store.position(D - 1)[p] = p % 128 == 0 ? grid.bottom() : grid.top();
    for (int c = 0; c < store.vorticity_components(); ++c)
      store.vorticity(c)[p] = uniform(random, -0.05, 0.05);
    // Two parcels of three are at corners: the third shows whether the rest is in order.
    for (std::size_t s = 0; s < store.scalars().size(); ++s)
      store.scalar(static_cast<int>(s))[p] =
          draw_scalar(random, store.scalars()[s], corners && p % 3 != 0);
    share_budgets(store, p);
    if (store.carries_size()) store.size_volume()[p] = store.volume()[p] * uniform(random, 1, 1.5);
    D == 3 ? draw_shape_3d(store, p, random) : draw_shape_2d(store, p, random);
  }
}

template void draw_population<2>(parcels::Store&, const mesh::Grid<2>&, Random&, bool);
template void draw_population<3>(parcels::Store&, const mesh::Grid<3>&, Random&, bool);

}  // namespace pileus::conform

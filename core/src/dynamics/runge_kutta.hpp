// Low-storage Runge–Kutta schemes in Williamson's 2N form.
#pragma once
#include <array>
#include <span>

namespace pileus::dynamics {

/// k ← A_s k + f(y); y ← y + B_s Δt k, with A_1 = 0; stage s is evaluated at time t + C_s Δt.
struct LowStorageScheme {
  std::span<const double> a, b, c;
  int order;
  std::size_t stages() const { return b.size(); }
};

/// Order 4 in 5 stages: Carpenter and Kennedy 1994, NASA TM-109112, solution 3.
inline const LowStorageScheme& carpenter_kennedy_4() {
  static constexpr std::array<double, 5> a = {
      0.0, -567301805773.0 / 1357537059087.0, -2404267990393.0 / 2016746695238.0,
      -3550918686646.0 / 2091501179385.0, -1275806237668.0 / 842570457699.0};
  static constexpr std::array<double, 5> b = {
      1432997174477.0 / 9575080441755.0, 5161836677717.0 / 13612068292357.0,
      1720146321549.0 / 2090206949498.0, 3134564353537.0 / 4481467310338.0,
      2277821191437.0 / 14882151754819.0};
  static constexpr std::array<double, 5> c = {
      0.0, 1432997174477.0 / 9575080441755.0, 2526269341429.0 / 6820363962896.0,
      2006345519317.0 / 3224310063776.0, 2802321613138.0 / 2924317926251.0};
  static constexpr LowStorageScheme scheme{a, b, c, 4};
  return scheme;
}

/// Order 3 in 3 stages: Williamson 1980, J. Comput. Phys. 35, 48.
inline const LowStorageScheme& williamson_3() {
  static constexpr std::array<double, 3> a = {0.0, -5.0 / 9.0, -153.0 / 128.0};
  static constexpr std::array<double, 3> b = {1.0 / 3.0, 15.0 / 16.0, 8.0 / 15.0};
  static constexpr std::array<double, 3> c = {0.0, 1.0 / 3.0, 3.0 / 4.0};
  static constexpr LowStorageScheme scheme{a, b, c, 3};
  return scheme;
}

}  // namespace pileus::dynamics

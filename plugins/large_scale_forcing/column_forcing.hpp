// The forcing of a run on the levels of its mesh: integrals of the given profiles, formed once.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "profile_integrals.hpp"

namespace pileus::large_scale {

/// A horizontal wind that is aimed at.
struct WindProfiles {
  PiecewiseLinear x, y;
};

/// The same on the levels: mean shear of the components over the hat functions, s⁻¹, and their
/// means over the depth, m s⁻¹.
struct LevelWind {
  std::array<std::vector<double>, 2> shear;
  std::array<double, 2> mean{};

  LevelWind() = default;
  LevelWind(const WindProfiles& wind, const Levels& levels) {
    for (std::size_t c = 0; c < 2; ++c) {
      const PiecewiseLinear& profile = c == 0 ? wind.x : wind.y;
      shear[c].resize(levels.count());
      for (std::size_t k = 0; k < levels.count(); ++k)
        shear[c][k] = slope_integral(profile, levels, k) / levels.length(k);
      mean[c] = depth_mean(profile, levels);
    }
  }
};

struct Profiles {
  PiecewiseLinear subsidence;                          // m s⁻¹
  PiecewiseLinear temperature, total_water, buoyancy;  // tendencies: K s⁻¹, s⁻¹, m s⁻³
  PiecewiseLinear sponge;                              // s⁻¹
  WindProfiles push;                                   // m s⁻²
  WindProfiles target, geostrophic;                    // m s⁻¹
};

struct ColumnForcing {
  Levels levels;
  double area = 0;                         // of the ground, m²; in the plane its length, m
  std::vector<LayerIntegrals> subsidence;  // m² s⁻¹
  double subsidence_at_bottom = 0, subsidence_at_top = 0, fastest_subsidence = 0;  // m s⁻¹
  std::vector<double> temperature, total_water, buoyancy;                          // ∫ S w_k dz
  std::vector<double> sponge;  // mean rate over w_k, s⁻¹
  LevelWind push, target, geostrophic;

  ColumnForcing() = default;
  ColumnForcing(const Profiles& given, const Levels& on, double ground)
      : levels(on),
        area(ground),
        subsidence_at_bottom(given.subsidence(on.bottom)),
        subsidence_at_top(given.subsidence(on.top())),
        temperature(hat_integrals(given.temperature)),
        total_water(hat_integrals(given.total_water)),
        buoyancy(hat_integrals(given.buoyancy)),
        sponge(hat_integrals(given.sponge)),
        push(given.push, on),
        target(given.target, on),
        geostrophic(given.geostrophic, on) {
    for (std::size_t k = 0; k < levels.cells; ++k)
      subsidence.push_back(layer_integrals(given.subsidence, levels, k));
    for (std::size_t k = 0; k < levels.count(); ++k) sponge[k] /= levels.length(k);
    for (const auto& point : given.subsidence.points())
      fastest_subsidence = std::max(fastest_subsidence, std::abs(point.value));
  }

  bool is_built() const { return area > 0; }
  /// Subsidence moves nothing by more than half a level in one step, s.
  double longest_step() const {
    return fastest_subsidence > 0 ? 0.5 * levels.spacing / fastest_subsidence
                                  : std::numeric_limits<double>::infinity();
  }

 private:
  std::vector<double> hat_integrals(const PiecewiseLinear& profile) const {
    std::vector<double> integrals(levels.count());
    for (std::size_t k = 0; k < levels.count(); ++k)
      integrals[k] = hat_integral(profile, levels, k);
    return integrals;
  }
};

}  // namespace pileus::large_scale

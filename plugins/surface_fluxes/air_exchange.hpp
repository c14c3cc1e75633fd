// What goes through the ground at a point: from the wind, the temperature and the humidity there to
// fluxes and stress, by the scheme of choice.
#pragma once
#include <pileus/thermo.hpp>

#include <cmath>

#include "bulk.hpp"
#include "monin_obukhov.hpp"
#include "surface_stress.hpp"

namespace pileus::surface {

enum class ScalarFlux { prescribed, bulk, monin_obukhov };
enum class Momentum { none, friction_velocity, bulk, monin_obukhov };

/// What does not change during a run.
struct ExchangeSettings {
  ScalarFlux scalar_flux = ScalarFlux::prescribed;
  Momentum momentum = Momentum::none;
  SimilaritySettings similarity;
  bool waves = false;  // roughness of the sea instead of the given one
  Charnock sea;
  SurfaceLayer layer{10, 0.1, 0.1};
  BulkCoefficients bulk{};
};

/// What is prescribed at a time, and at a point where maps say so.
struct Prescribed {
  double heat = 0, moisture = 0, buoyancy = 0;  // K m s-1, m s-1, m2 s-3
  double friction_velocity = 0;                 // m s-1
  double theta = 300, humidity = 0;             // of the ground, K and 1
};

struct NearAir {
  double theta = 300, humidity = 0;  // at z_1, K and 1
};

/// Exchange velocities (m s-1) and fluxes of one point.
struct Transfer {
  double heat = 0, moisture = 0;  // <w'φ'> = velocity (φ_s − φ_1)
  double drag = 0;                // τ = drag u
  double friction_velocity = 0;
};
struct Fluxes {
  double heat = 0, moisture = 0, buoyancy = 0;  // K m s-1, m s-1, m2 s-3 (of θ_v)
};

class AirExchange {
 public:
  AirExchange() = default;
  explicit AirExchange(const ExchangeSettings& settings) : s_(settings) {
    const double adjusted = s_.bulk.adjustment(s_.layer.height, s_.layer.roughness);
    s_.bulk.momentum *= adjusted, s_.bulk.heat *= adjusted, s_.bulk.moisture *= adjusted;
  }

  Transfer transfer(const Prescribed& given, const NearAir& air, double speed) const {
    Transfer t;
    const double least = std::max(speed, s_.similarity.least_wind);
    Exchange exchange;
    if (s_.scalar_flux == ScalarFlux::bulk) {
      t.heat = s_.bulk.heat * least;
      t.moisture = s_.bulk.moisture * least;
    } else if (s_.scalar_flux == ScalarFlux::monin_obukhov) {
      exchange = by_difference(given, air, speed);
      t.heat = t.moisture = exchange.transfer;
      t.friction_velocity = exchange.friction_velocity;
    }
    if (s_.momentum == Momentum::friction_velocity) {
      t.friction_velocity = given.friction_velocity;
      t.drag = given.friction_velocity * given.friction_velocity / least;
    } else if (s_.momentum == Momentum::bulk) {
      t.drag = s_.bulk.momentum * least;
      t.friction_velocity = std::sqrt(t.drag * speed);
    } else if (s_.momentum == Momentum::monin_obukhov) {
      if (s_.scalar_flux != ScalarFlux::monin_obukhov)
        exchange = by_flux(fluxes(t, given, air, air, 1.0).buoyancy, speed);
      t.friction_velocity = exchange.friction_velocity;
      t.drag = exchange.drag();
    }
    return t;
  }

  /// Of the exchange velocities of `mean` air to the air at a point; the same for local exchange.
  /// `speed_ratio` is that of the wind there to its mean.
  Fluxes fluxes(const Transfer& t, const Prescribed& given, const NearAir& mean, const NearAir& air,
                double speed_ratio) const {
    Fluxes f{given.heat, given.moisture, 0};
    if (s_.scalar_flux != ScalarFlux::prescribed) {
      f.heat = distributed_flux(t.heat, speed_ratio, given.theta, mean.theta, air.theta);
      f.moisture =
          distributed_flux(t.moisture, speed_ratio, given.humidity, mean.humidity, air.humidity);
    }
    f.buoyancy = given.buoyancy + buoyancy_of(f.heat, f.moisture, air);
    return f;
  }

  const ExchangeSettings& settings() const { return s_; }
  /// Of a flux of heat and moisture: g/θ_00 of what θ_v = θ(1 + 0.608 q) gains.
  double buoyancy_of(double heat, double moisture, const NearAir& air) const {
    return per_kelvin() * (heat * (1 + thermo::virtual_factor * air.humidity) +
                           thermo::virtual_factor * air.theta * moisture);
  }
  /// g/θ_00, m s-2 K-1.
  double per_kelvin() const { return s_.similarity.gravity / s_.similarity.reference_temperature; }

 private:
  Exchange by_difference(const Prescribed& given, const NearAir& air, double speed) const {
    // As the flux of θ_v is made of those of θ and q.
    const double difference =
        (air.theta - given.theta) * (1 + thermo::virtual_factor * air.humidity) +
        thermo::virtual_factor * air.theta * (air.humidity - given.humidity);
    return solved([&](const SurfaceLayer& layer) {
      return Similarity(s_.similarity, layer).of_difference(speed, difference);
    });
  }
  Exchange by_flux(double buoyancy, double speed) const {
    return solved([&](const SurfaceLayer& layer) {
      return Similarity(s_.similarity, layer).of_flux(speed, buoyancy / per_kelvin());
    });
  }
  template <class Solve>
  Exchange solved(Solve&& solve) const {
    return s_.waves ? over_waves(s_.sea, s_.layer.height, solve) : solve(s_.layer);
  }

  ExchangeSettings s_;
};

}  // namespace pileus::surface

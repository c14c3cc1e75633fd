// The operator that exchanges heat, moisture and momentum between the ground and the parcels.
#include <pileus/plugin.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "air_exchange.hpp"
#include "ground_layer.hpp"
#include "parameters.hpp"
#include "quantities.hpp"
#include "surface_stress.hpp"

namespace pileus::surface {
namespace {

Ground ground_of(const Block& block) {
  const pileus_grid* grid = block.raw().grid;
  if (grid == nullptr) throw Failure("there is no ground without a mesh");
  const bool plane = grid->dimension == 2;
  Ground g;
  g.cells = {grid->cells[0], plane ? 1 : grid->cells[1]};
  g.origin = {grid->origin[0], plane ? 0.0 : grid->origin[1]};
  g.spacing = {grid->spacing[0], plane ? 1.0 : grid->spacing[1]};
  g.bottom = grid->origin[2];
  g.depth = grid->spacing[2];
  g.height = grid->spacing[2] * static_cast<double>(grid->cells[2]);
  return g;
}

/// Values at the surface points during one call.
struct PointFields {
  PointFields(const Block& block, std::size_t points) {
    constexpr std::size_t fields = 13;
    const std::span<double> room = block.scratch(fields * points);
    std::fill(room.begin(), room.end(), 0.0);
    std::size_t at = 0;
    for (std::span<double>* s :
         {&sums.reach, &sums.volume, &theta, &humidity, &wind_x, &wind_y, &heat, &moisture,
          &buoyancy, &stress_x, &stress_y, &amount, &share}) {
      *s = room.subspan(at, points);
      at += points;
    }
  }
  PointSums sums;
  std::span<double> theta, humidity, wind_x, wind_y;  // of the air at z_1
  std::span<double> heat, moisture, buoyancy;         // fluxes
  std::span<double> stress_x, stress_y;
  std::span<double> amount, share;
};

constexpr const char* too_strong =
    "the flux of the ground is beyond what air can take up; look at the stated fluxes, their maps "
    "and the state of the ground, or take shorter steps";

class SurfaceFluxes : public Operator<SurfaceFluxes> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    parameters_.describe(d);
    q_.describe(d);
    heat_ = d.budget("heat");
    water_ = d.budget("water");
    buoyancy_ = d.budget("buoyancy");
  }

  void configured() {
    settings_ = parameters_.settings([this](Param p) { return value(p); },
                                     [this](Param p) { return choice(p); });
    heat_flux_ = profile(parameters_.heat_flux);
    moisture_flux_ = profile(parameters_.moisture_flux);
    buoyancy_flux_ = profile(parameters_.buoyancy_flux);
    friction_velocity_ = profile(parameters_.friction_velocity);
    theta_ = profile(parameters_.theta);
    humidity_ = profile(parameters_.humidity);
    check_bulk();
  }

  /// The force of the ground moves or stops the air of the lowest cell within the limit.
  double prepare(const pileus_step& step, Block block) const {
    const Ground ground = ground_of(block);
    const double factor = value(parameters_.step_limit);
    double limit = std::numeric_limits<double>::infinity();
    const double flux =
        std::max(greatest(block, q_.buoyancy_flux), prescribed_buoyancy(step, block));
    if (flux > 0) limit = factor * std::cbrt(ground.depth * ground.depth / (2 * flux));
    if (settings_.momentum == Momentum::none) return limit;
    // The drag C|U| of a layer is below u*; of a stated u*, the wind is cut off.
    double drag = greatest(block, q_.friction_velocity);
    if (settings_.momentum == Momentum::friction_velocity) {
      const double u =
          std::max(friction_velocity_(step.time), friction_velocity_(step.time + step.dt));
      drag = u * std::max(1.0, u / settings_.similarity.least_wind);
    }
    return drag > 0 ? std::min(limit, factor * stress_depth(ground) / drag) : limit;
  }

  void apply(const pileus_step& step, Block block) const {
    const Ground ground = ground_of(block);
    check(block, ground);
    PointFields f(block, ground.points());
    const ParcelArrays parcels{block.in(q_.x), block.has(q_.y) ? block.in(q_.y) : nullptr,
                               block.in(q_.z), block.in(q_.volume), block.count()};
    const double reach = reach_of(block, ground);
    const std::size_t near = GroundLayer::count_below(ground, parcels, reach);
    GroundLayer layer(ground, parcels, reach,
                      {reinterpret_cast<std::int64_t*>(block.scratch(near).data()), near});
    std::uint64_t repairs = 0;
    if (needs_air(block)) repairs += read_air(block, ground, layer, f);
    if (settings_.momentum != Momentum::none) read_wind(block, ground, f);
    find_fluxes(step, block, ground, f);
    repairs += layer.weigh(VerticalWeight::ramp, ground.depth, f.sums);
    heat(step, block, ground, layer, f);
    repairs += moisten(step, block, ground, layer, f);
    if (settings_.momentum != Momentum::none) repairs += drag(step, block, ground, layer, f);
    block.repaired(repairs);
  }

 private:
  Slot heated(const Block& block) const {
    for (const Slot slot : {q_.theta_l, q_.theta, q_.buoyancy_l, q_.buoyancy})
      if (block.has(slot)) return slot;
    return {};
  }
  Slot moistened(const Block& block) const {
    for (const Slot slot : {q_.total_water, q_.vapour})
      if (block.has(slot)) return slot;
    return {};
  }
  static bool is(Slot slot) { return slot.index != Slot{}.index; }
  bool has_temperature(const Block& block) const {
    return block.has(q_.theta_l) || block.has(q_.theta);
  }
  bool needs_air(const Block& block) const {
    return settings_.scalar_flux != ScalarFlux::prescribed || is(moistened(block));
  }
  double stress_depth(const Ground& ground) const {
    return std::min(static_cast<double>(integer(parameters_.stress_depth)) * ground.depth,
                    ground.height);
  }
  /// Parcels below it take part.
  double reach_of(const Block& block, const Ground& ground) const {
    const double read = needs_air(block) ? 2 * ground.depth : ground.depth;
    return settings_.momentum == Momentum::none ? read : std::max(read, stress_depth(ground));
  }

  /// Needs no mesh: found before the first step.
  void check_bulk() const {
    const bool bulk =
        settings_.scalar_flux == ScalarFlux::bulk || settings_.momentum == Momentum::bulk;
    if (bulk && !settings_.bulk.is_above(settings_.layer.roughness))
      throw Failure(
          "roughness_length has to be below coefficient_height: the coefficients of bulk formulas "
          "are those of a height in the air, adjusted by ln(coefficient_height/roughness_length)",
          PILEUS_E_CONFIG);
  }

  void check(const Block& block, const Ground& ground) const {
    const bool stated = settings_.scalar_flux == ScalarFlux::prescribed;
    if (!is(heated(block)) && !(stated && heat_flux_.is_zero() && buoyancy_flux_.is_zero()))
      throw Failure("parcels carry no temperature and no buoyancy that the ground could heat",
                    PILEUS_E_CONFIG);
    if (stated && !is(moistened(block)) && !moisture_flux_.is_zero())
      throw Failure("parcels carry no water for the moisture_flux; give them an initial humidity",
                    PILEUS_E_CONFIG);
    if (stated && has_temperature(block) && !buoyancy_flux_.is_zero())
      throw Failure("parcels carry a temperature; state heat_flux instead of buoyancy_flux",
                    PILEUS_E_CONFIG);
    if (!(settings_.layer.roughness < 0.5 * ground.depth &&
          settings_.layer.heat_roughness < 0.5 * ground.depth))
      throw Failure("roughness_length has to be below half the height of a cell", PILEUS_E_CONFIG);
  }

  /// Mean of a series over the step: what it prescribes is exact whatever the steps.
  static double over(const PiecewiseLinear& series, const pileus_step& step) {
    if (series.is_constant() || !(step.dt > 0)) return series(step.time);
    return series.integral(step.time, step.time + step.dt) / step.dt;
  }

  /// Temperature, humidity, and the wind where no drag asks for the mesh, around z_1.
  std::uint64_t read_air(const Block& block, const Ground& ground, GroundLayer& layer,
                         PointFields& f) const {
    const std::uint64_t widened = layer.weigh(VerticalWeight::tent, ground.depth, f.sums);
    const double reference = settings_.similarity.reference_temperature;
    const Slot warm = heated(block);
    std::fill(f.theta.begin(), f.theta.end(), reference);
    if (has_temperature(block)) {
      layer.mean(VerticalWeight::tent, f.sums, block.in(warm), reference, f.theta);
    } else if (is(warm)) {
      layer.mean(VerticalWeight::tent, f.sums, block.in(warm), 0.0, f.theta);
      for (double& t : f.theta) t = reference + t * reference / settings_.similarity.gravity;
    }
    if (const Slot wet = moistened(block); is(wet))
      layer.mean(VerticalWeight::tent, f.sums, block.in(wet), 0.0, f.humidity);
    if (block.has(q_.wind_x_at_parcels))
      layer.mean(VerticalWeight::tent, f.sums, block.in(q_.wind_x_at_parcels), 0.0, f.wind_x);
    if (block.has(q_.wind_y_at_parcels))
      layer.mean(VerticalWeight::tent, f.sums, block.in(q_.wind_y_at_parcels), 0.0, f.wind_y);
    return widened;
  }

  /// Of the first level above the ground: the mean of the four nodes around a point.
  void read_wind(const Block& block, const Ground& ground, PointFields& f) const {
    const std::int64_t nx = ground.cells[0], ny = ground.cells[1];
    const std::int64_t levels = block.raw().grid->cells[2] + 3;
    const auto mean = [&](Slot slot, std::span<double> wind) {
      if (!block.has(slot)) return;
      const auto at = block.strided_in<double>(slot);
      const auto node = [&](std::int64_t i, std::int64_t j) {
        return at((i % nx + nx * (j % ny)) * levels + 2);  // level 1
      };
      for (std::int64_t j = 0; j < ny; ++j)
        for (std::int64_t i = 0; i < nx; ++i)
          wind[static_cast<std::size_t>(i + nx * j)] =
              0.25 * (node(i, j) + node(i + 1, j) + node(i, j + 1) + node(i + 1, j + 1));
    };
    mean(q_.wind_x, f.wind_x);
    mean(q_.wind_y, f.wind_y);
  }

  Prescribed prescribed(const pileus_step& step) const {
    return {over(heat_flux_, step),         over(moisture_flux_, step), over(buoyancy_flux_, step),
            over(friction_velocity_, step), over(theta_, step),         over(humidity_, step)};
  }

  void find_fluxes(const pileus_step& step, const Block& block, const Ground& ground,
                   PointFields& f) const {
    ExchangeSettings settings = settings_;
    settings.layer.height = ground.depth;
    const AirExchange exchange(settings);
    const Prescribed given = prescribed(step);
    const bool by_plane = choice(parameters_.stress) == 1;
    const NearAir mean_air{mean_of(f.theta), mean_of(f.humidity)};
    const PlaneWind plane = plane_wind(f);
    const Transfer of_plane =
        by_plane ? exchange.transfer(given, mean_air, plane.speed) : Transfer{};
    double* friction = block.out(q_.friction_velocity);
    double* const out[] = {block.out(q_.heat_flux), block.out(q_.moisture_flux),
                           block.out(q_.buoyancy_flux)};
    const double least = settings.similarity.least_wind;
    parallel_for(static_cast<std::int64_t>(ground.points()), [&](std::int64_t point) {
      const auto j = static_cast<std::size_t>(point);
      Prescribed here = given;
      here.heat *= block.in(q_.heat_map)[j];
      here.buoyancy *= block.in(q_.heat_map)[j];
      here.moisture *= block.in(q_.moisture_map)[j];
      const NearAir air{f.theta[j], f.humidity[j]};
      const HorizontalVector wind{f.wind_x[j], f.wind_y[j]};
      const double speed = std::hypot(wind.x, wind.y);
      const Transfer t = by_plane ? of_plane : exchange.transfer(here, air, speed);
      const double ratio = std::max(speed, least) / std::max(plane.speed, least);
      const Fluxes fluxes =
          exchange.fluxes(t, here, by_plane ? mean_air : air, air, by_plane ? ratio : 1.0);
      HorizontalVector stress{t.drag * wind.x, t.drag * wind.y};
      if (by_plane)
        stress =
            distributed_stress(t.drag * std::max(plane.speed, least), plane, wind, speed, least);
      f.stress_x[j] = stress.x, f.stress_y[j] = stress.y;
      f.heat[j] = out[0][j] = fluxes.heat;
      f.moisture[j] = out[1][j] = fluxes.moisture;
      out[2][j] = fluxes.buoyancy;
      f.buoyancy[j] = exchange.per_kelvin() * fluxes.heat + here.buoyancy;
      friction[j] = t.friction_velocity;
    });
    for (const Slot slot : {q_.friction_velocity, q_.heat_flux, q_.moisture_flux, q_.buoyancy_flux})
      expect_in_range(block, slot, too_strong);
  }

  static double mean_of(std::span<const double> values) {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
  }
  static PlaneWind plane_wind(const PointFields& f) {
    PlaneWind plane{{mean_of(f.wind_x), mean_of(f.wind_y)}, 0};
    for (std::size_t j = 0; j < f.wind_x.size(); ++j)
      plane.speed += std::hypot(f.wind_x[j], f.wind_y[j]);
    plane.speed /= static_cast<double>(f.wind_x.size());
    return plane;
  }

  /// Shares of what is in `amount`; returns the sum of what has parcels to go to.
  static double share_out(PointFields& f) {
    double sum = 0;
    for (std::size_t j = 0; j < f.amount.size(); ++j) {
      const bool reached = f.sums.volume[j] > 0;
      f.share[j] = reached ? f.amount[j] / f.sums.volume[j] : 0.0;
      sum += reached ? f.amount[j] : 0.0;
    }
    return sum;
  }
  static bool all_zero(std::span<const double> values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return v == 0; });
  }

  void heat(const pileus_step& step, const Block& block, const Ground& ground,
            const GroundLayer& layer, PointFields& f) const {
    const Slot slot = heated(block);
    if (!is(slot)) return;
    const std::span<const double> flux = has_temperature(block) ? f.heat : f.buoyancy;
    if (all_zero(flux)) return;
    for (std::size_t j = 0; j < flux.size(); ++j) f.amount[j] = step.dt * flux[j] * ground.area();
    const double sum = share_out(f);
    layer.add(VerticalWeight::ramp, f.sums, f.share, block.out(slot));
    expect_in_range(block, slot, too_strong);
    if (slot.index == q_.theta_l.index) block.book(heat_, sum);
    if (!has_temperature(block)) block.book(buoyancy_, sum);
  }

  std::uint64_t moisten(const pileus_step& step, const Block& block, const Ground& ground,
                        const GroundLayer& layer, PointFields& f) const {
    const Slot slot = moistened(block);
    if (!is(slot)) return 0;
    const std::span<double> owed(block.out(q_.owed), ground.points());
    if (all_zero(f.moisture) && all_zero(owed)) return 0;
    for (std::size_t j = 0; j < owed.size(); ++j) {
      f.amount[j] = (step.dt * f.moisture[j] + owed[j]) * ground.area();
      owed[j] = f.sums.volume[j] > 0 ? 0.0 : f.amount[j];
    }
    double sum = share_out(f);
    std::fill(f.amount.begin(), f.amount.end(), 0.0);
    const std::uint64_t cut =
        layer.add_to_fraction(VerticalWeight::ramp, f.sums, f.share, block.out(slot), f.amount);
    for (std::size_t j = 0; j < owed.size(); ++j) {
      sum -= f.amount[j];
      owed[j] = (owed[j] + f.amount[j]) / ground.area();
    }
    expect_in_range(block, q_.owed, too_strong);
    expect_in_range(block, slot, too_strong);
    block.book(water_, sum);
    return cut;
  }

  std::uint64_t drag(const pileus_step& step, const Block& block, const Ground& ground,
                     GroundLayer& layer, PointFields& f) const {
    block.out(q_.mean_wind_x)[0] += mean_wind_change(ground, f.stress_x, step.dt);
    if (block.has(q_.mean_wind_y))
      block.out(q_.mean_wind_y)[0] += mean_wind_change(ground, f.stress_y, step.dt);
    const double depth = stress_depth(ground);
    if (block.has(q_.vorticity_z)) {
      layer.weigh(VerticalWeight::ramp, depth, f.sums);
      vertical_vorticity_amounts(ground, f.stress_x, f.stress_y, step.dt, f.amount);
      share_out(f);
      layer.add(VerticalWeight::ramp, f.sums, f.share, block.out(q_.vorticity_z));
    }
    const std::uint64_t widened = layer.weigh(VerticalWeight::box, depth, f.sums);
    const auto turn = [&](Slot slot, std::span<const double> stress, double sign) {
      if (!block.has(slot)) return;
      for (std::size_t j = 0; j < stress.size(); ++j)
        f.amount[j] = sign * vorticity_amount(ground, depth, stress[j], step.dt);
      share_out(f);
      layer.add(VerticalWeight::box, f.sums, f.share, block.out(slot));
    };
    turn(q_.vorticity_2d, f.stress_x, -1);
    turn(q_.vorticity_y, f.stress_x, 1);
    turn(q_.vorticity_x, f.stress_y, -1);
    return widened;
  }

  double greatest(const Block& block, Slot slot) const {
    const double* values = block.in(slot);
    return std::max(0.0, *std::max_element(values, values + block.elements(slot)));
  }
  /// The largest of the stated fluxes at both ends of a step, before the first call knows them.
  double prescribed_buoyancy(const pileus_step& step, const Block& block) const {
    if (settings_.scalar_flux != ScalarFlux::prescribed) return 0;
    const double g = settings_.similarity.gravity / settings_.similarity.reference_temperature;
    const double heat_map = greatest(block, q_.heat_map);
    const double moisture_map = greatest(block, q_.moisture_map);
    double most = 0;
    for (const double time : {step.time, step.time + step.dt})
      most = std::max(most, heat_map * (g * heat_flux_(time) + buoyancy_flux_(time)) +
                                moisture_map * settings_.similarity.gravity *
                                    thermo::virtual_factor * moisture_flux_(time));
    return most;
  }

  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.surface_fluxes";
    d.op.kind = "surface";
    d.op.version = "1.0.0";
    d.op.title = "Fluxes between the ground and the air";
    d.op.summary =
        "Gives heat and moisture to the parcels next to the ground and drags the wind there, by "
        "stated fluxes, bulk formulas or similarity theory, exactly conserving.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("surface_fluxes");
    d.cites("10.1016/j.jcpx.2023.100136",
            "Frey et al. 2023: EPIC, whose shape of the flux this has");
    d.cites("10.1007/BF00240838", "Dyer 1974: stability functions");
    d.cites("10.1023/A:1018718707419", "Wilson 2001: stability functions in free convection");
    d.cites("10.1002/qj.49712152203", "Beljaars 1995: gustiness");
    d.cites("10.1029/2011MS000056", "van Zanten et al. 2011: bulk coefficients of RICO");
  }

  Parameters parameters_;
  Quantities q_;
  Budget heat_, water_, buoyancy_;
  ExchangeSettings settings_;
  PiecewiseLinear heat_flux_, moisture_flux_, buoyancy_flux_, friction_velocity_, theta_, humidity_;
};

}  // namespace
}  // namespace pileus::surface

PILEUS_PLUGIN(pileus::surface::SurfaceFluxes, "org.pileus.surface_fluxes", "1.0.0");

// Sub-grid motion of the parcels: Brownian or Langevin, in the form that keeps a well-mixed
// population well mixed.
#include <pileus/normal.hpp>
#include <pileus/plugin.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "displacement.hpp"
#include "node_field.hpp"

namespace pileus::langevin {
namespace {

constexpr const char* brownian = "model == brownian";
constexpr const char* langevin = "model == langevin";
/// In units of its standard deviation, so that none comes near.
constexpr double largest_velocity = 1e6;

class LangevinMixing : public Operator<LangevinMixing> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    describe_parameters(d);
    describe_quantities(d);
  }

  void configured() {
    const NamedList heights{"profile_height", list(profile_height_)};
    diffusivity_profile_ = profile_of_lists(heights, {"diffusivity", list(diffusivity_)});
    variance_profile_ = profile_of_lists(heights, {"velocity_variance", list(variance_)});
  }

  double prepare(const pileus_step&, Block whole) {
    const pileus_grid& grid = mesh_of(whole);
    double finest = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a)
      if (a != 1 || grid.dimension == 3) finest = std::min(finest, grid.spacing[a]);
    const double most = value(courant_) * finest;
    const double strain = choice(from_) == 0 ? largest_strain(whole) : 0.0;
    if (choice(model_) == 0) {
      const double k = choice(from_) == 0 ? diffusivity_per_strain(grid) * strain
                                          : *std::max_element(list(diffusivity_).begin(),
                                                              list(diffusivity_).end());
      return k > 0 ? most * most / (2 * k) : std::numeric_limits<double>::infinity();
    }
    double sigma, time_scale;
    if (choice(from_) == 0) {
      sigma = sigma_per_strain(grid) * strain;
      time_scale = value(time_per_strain_) / strain;
    } else {
      sigma = std::sqrt(*std::max_element(list(variance_).begin(), list(variance_).end()));
      time_scale = value(time_scale_);
    }
    // Ballistic at first, diffusive after a while: resolve the path and the memory.
    if (!(sigma > 0)) return std::numeric_limits<double>::infinity();
    return std::min(most / sigma, value(memory_steps_) * time_scale);
  }

  void apply(const pileus_step& step, Block block) const {
    if (mesh_of(block).dimension == 3)
      displace<3>(step, block);
    else
      displace<2>(step, block);
  }

 private:
  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.langevin_mixing";
    d.op.kind = "mixing";
    d.op.version = "1.0.0";
    d.op.title = "Sub-grid motion of parcels";
    d.op.summary =
        "Displaces parcels at random by eddy diffusion or by a Langevin equation, keeping what is "
        "well mixed well mixed.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.flags = PILEUS_RANDOM;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("subgrid_displacement");
    d.cites("10.1017/S0022112087001940", "Thomson 1987: the well-mixed criterion");
  }

  void describe_parameters(Declaration& d) {
    static constexpr double courants[] = {1.0, 0.5, 0.25, std::numeric_limits<double>::quiet_NaN()};
    static constexpr double memories[] = {0.5, 0.25, 0.1, 0.05,
                                          std::numeric_limits<double>::quiet_NaN()};
    model_ = d.choice("model", {"brownian", "langevin"})
                 .doc("uncorrelated displacements, or velocities with a memory");
    from_ = d.choice("intensity", {"strain", "profile"})
                .doc("from the strain of the flow, or given over height (one value: everywhere)");
    smagorinsky_ = d.number("smagorinsky", "1", 0.2)
                       .range(0.0, 10.0)
                       .when("model == brownian and intensity == strain")
                       .doc("C_s in K = (C_s Δ)² |S|, Δ the mean mesh width");
    energy_ = d.number("energy", "1", 0.1)
                  .range(0.0, 100.0)
                  .when("model == langevin and intensity == strain")
                  .doc("C in the sub-grid kinetic energy C Δ² |S|², of which σ² is two thirds");
    time_per_strain_ = d.number("memory", "1", 1.0)
                           .range(1e-3, 1e3)
                           .when("model == langevin and intensity == strain")
                           .doc("T_L |S|: the correlation time in units of 1/|S|");
    profile_height_ = d.numbers("profile_height", "m", 0.0)
                          .range(-1e6, 1e6)
                          .when("intensity == profile")
                          .doc("heights of the profile, ascending");
    diffusivity_ = d.numbers("diffusivity", "m2 s-1", 0.0)
                       .range(0.0, 1e9)
                       .when("model == brownian and intensity == profile")
                       .doc("K at those heights");
    variance_ = d.numbers("velocity_variance", "m2 s-2", 0.0)
                    .range(0.0, 1e6)
                    .when("model == langevin and intensity == profile")
                    .doc("σ² of each velocity component at those heights");
    time_scale_ = d.number("time_scale", "s", 100.0)
                      .range(1e-6, 1e9)
                      .when("model == langevin and intensity == profile")
                      .doc("correlation time T_L");
    courant_ = d.number("courant", "1", 0.5)
                   .range(0.01, 2.0)
                   .knob(courants)
                   .doc("largest typical displacement of a sub-step in mesh widths");
    memory_steps_ = d.number("memory_step", "1", 0.25)
                        .range(0.001, 2.0)
                        .knob(memories)
                        .when(langevin)
                        .doc("largest sub-step in units of the correlation time");
  }

  void describe_quantities(Declaration& d) {
    position_[0] = d.updates("x_position", "m").doc("of the parcel's centre");
    position_[1] = d.updates("y_position", "m").optional().doc("in three dimensions");
    position_[2] = d.updates("z_position", "m").doc("of the parcel's centre");
    strain_ = d.reads_mesh("strain_rate_magnitude", "s-1")
                  .when("intensity == strain")
                  .doc("of the gridded flow");
    volume_ = d.reads("parcel_volume", "m3").when(langevin).doc("to notice mergers");
    velocity_[0] = own_velocity(d, "x_normalised_turbulent_velocity");
    velocity_[1] = own_velocity(d, "y_normalised_turbulent_velocity");
    velocity_[2] = own_velocity(d, "z_normalised_turbulent_velocity");
    weight_ = d.owns("turbulent_velocity_weight", "m6")
                  .extensive()
                  .range(0.0, 1e300)
                  .when(langevin)
                  .doc("V² of independent velocities; at a merge it falls below the square of V");
  }
  static Slot own_velocity(Declaration& d, const char* name) {
    return d.owns(name, "1")
        .intensive()
        .range(-largest_velocity, largest_velocity)
        .when(langevin)
        .doc("velocity fluctuation over its standard deviation");
  }

  static const pileus_grid& mesh_of(Block block) {
    const pileus_grid* grid = block.raw().grid;
    if (grid == nullptr) throw Failure("it needs a mesh, which this run does not have");
    return *grid;
  }
  static double mesh_width(const pileus_grid& grid) {
    const double area = grid.spacing[0] * grid.spacing[2];
    return grid.dimension == 3 ? std::cbrt(area * grid.spacing[1]) : std::sqrt(area);
  }
  double diffusivity_per_strain(const pileus_grid& grid) const {
    const double length = value(smagorinsky_) * mesh_width(grid);
    return length * length;
  }
  /// σ/|S| with σ² = (2/3) C Δ² |S|².
  double sigma_per_strain(const pileus_grid& grid) const {
    return std::sqrt(2.0 / 3.0 * value(energy_)) * mesh_width(grid);
  }
  double largest_strain(Block whole) const {
    const pileus_view& view = whole.raw().views[strain_.index];
    const Strided<const double> strain(view);
    double largest = 0;
    for (std::int64_t node = 0; node < view.count; ++node)
      largest = std::max(largest, strain(node));
    return largest;
  }

  template <int D>
  static Local<D> at_height(const PiecewiseLinear& profile, double z) {
    Local<D> result;
    result.value = profile(z);
    result.gradient[D - 1] = profile.derivative(z);
    return result;
  }
  template <int D>
  static Local<D> scaled(double factor, Local<D> local) {
    local.value *= factor;
    for (double& g : local.gradient) g *= factor;
    return local;
  }
  /// σ from σ²: ∇σ = ∇σ²/(2σ).
  template <int D>
  static Local<D> root(Local<D> squared) {
    const double sigma = std::sqrt(squared.value);
    for (double& g : squared.gradient) g = sigma > 0 ? 0.5 * g / sigma : 0.0;
    squared.value = sigma;
    return squared;
  }

  /// The columns of one block, positions and velocities in the order of the directions.
  template <int D>
  struct Columns {
    double* position[D];
    double* velocity[D];
  };
  template <int D>
  Columns<D> columns(Block block, bool with_velocity) const {
    Columns<D> c{};
    for (int d = 0; d < D; ++d) {
      const std::size_t axis = d == D - 1 ? 2 : static_cast<std::size_t>(d);
      c.position[d] = block.out(position_[axis]);
      if (with_velocity) c.velocity[d] = block.out(velocity_[axis]);
    }
    return c;
  }

  template <int D>
  void displace(const pileus_step& step, Block block) const {
    const pileus_grid& grid = mesh_of(block);
    const bool from_strain = choice(from_) == 0;
    const pileus_view nothing{};
    const NodeField<D> strain(grid, from_strain ? block.raw().views[strain_.index] : nothing);
    if (choice(model_) == 0) {
      const double factor = from_strain ? diffusivity_per_strain(grid) : 0.0;
      move_brownian<D>(step, block, [&](const double* x) {
        return from_strain ? scaled(factor, strain.at(x))
                           : at_height<D>(diffusivity_profile_, x[D - 1]);
      });
    } else {
      const double factor = from_strain ? sigma_per_strain(grid) : 0.0;
      move_langevin<D>(
          step, block,
          [&](const double* x) {
            return from_strain ? scaled(factor, strain.at(x))
                               : root(at_height<D>(variance_profile_, x[D - 1]));
          },
          [&](const double* x) {
            return from_strain ? value(time_per_strain_) / strain.at(x).value : value(time_scale_);
          });
    }
  }

  template <int D, class Diffusivity>
  void move_brownian(const pileus_step& step, Block block, Diffusivity&& diffusivity) const {
    const pileus_grid& grid = mesh_of(block);
    const double bottom = grid.origin[2],
                 top = bottom + static_cast<double>(grid.cells[2]) * grid.spacing[2];
    const Columns<D> c = columns<D>(block, false);
    block.each([&](auto p) {
      double x[D], shift[D], normal[D];
      for (int d = 0; d < D; ++d) x[d] = c.position[d][p];
      draw_normal(step, block.uid(p), 0, D, normal);
      brownian_displacement<D>(diffusivity(x), step.dt, normal, shift);
      bool turned;
      for (int d = 0; d < D; ++d) c.position[d][p] += shift[d];
      c.position[D - 1][p] = reflected(c.position[D - 1][p], bottom, top, turned);
    });
  }

  template <int D, class Sigma, class TimeScale>
  void move_langevin(const pileus_step& step, Block block, Sigma&& sigma,
                     TimeScale&& time_scale) const {
    const pileus_grid& grid = mesh_of(block);
    const double bottom = grid.origin[2],
                 top = bottom + static_cast<double>(grid.cells[2]) * grid.spacing[2];
    const Columns<D> c = columns<D>(block, true);
    const double* volume = block.in(volume_);
    double* weight = block.out(weight_);
    std::uint64_t held = 0;
    block.each([&](auto p) {
      double x[D], w[D], normal[2 * D];
      for (int d = 0; d < D; ++d) x[d] = c.position[d][p], w[d] = c.velocity[d][p];
      restore_variance<D>(step, block.uid(p), volume[p], weight[p], w);
      draw_normal(step, block.uid(p), 0, 2 * D, normal);
      langevin_step<D>(
          x, w, step.dt, [&](const double* at) { return even_at_walls<D>(sigma, at, bottom, top); },
          time_scale, normal);
      bool turned;
      x[D - 1] = reflected(x[D - 1], bottom, top, turned);
      if (turned) w[D - 1] = -w[D - 1];
      for (int d = 0; d < D; ++d) {
        c.position[d][p] = x[d];
        c.velocity[d][p] = std::clamp(w[d], -largest_velocity, largest_velocity);
        if (std::abs(w[d]) > largest_velocity) ++held;
      }
    });
    block.repaired(held);
  }

  /// A merged parcel moves with the mean of its parts' velocities, whose variance is Σ μ² of theirs
  /// (μ: parts of the volume): the rest is drawn anew. The weight is a sum over parts of V², so it
  /// tells Σ μ²; a new parcel has none and draws all of its velocity. Halves of a split parcel keep
  /// its velocity.
  template <int D>
  static void restore_variance(const pileus_step& step, std::uint64_t uid, double volume,
                               double& weight, double* w) {
    const double squared = volume * volume;
    const double kept = weight / squared;
    weight = squared;
    if (kept >= 1.0 - 1e-12) return;
    double normal[D];
    draw_normal(step, uid, 1, D, normal);
    for (int d = 0; d < D; ++d) w[d] += std::sqrt(1.0 - kept) * normal[d];
  }

  std::array<Slot, 3> position_, velocity_;
  Slot strain_, volume_, weight_;
  Param model_, from_, smagorinsky_, energy_, time_per_strain_;
  Param profile_height_, diffusivity_, variance_, time_scale_, courant_, memory_steps_;
  PiecewiseLinear diffusivity_profile_, variance_profile_;
};

}  // namespace
}  // namespace pileus::langevin

PILEUS_PLUGIN(pileus::langevin::LangevinMixing, "org.pileus.langevin_mixing", "1.0.0");

// Mixing of parcels through the mesh: each relaxes towards what its neighbourhood holds, at a rate
// set by the strain of the flow, exactly conserving and monotone.
#include <pileus/mesh.hpp>
#include <pileus/mixed_scalars.hpp>
#include <pileus/numerics.hpp>

#include <array>
#include <limits>
#include <string_view>

#include "nudging.hpp"

namespace pileus::nudging {
namespace {

/// Profiles that perturbations may be measured from.
enum class Reference { buoyancy, potential_temperature, total_water, none };

Reference reference_of(std::string_view scalar) {
  if (scalar.ends_with("buoyancy")) return Reference::buoyancy;
  if (scalar.ends_with("potential_temperature")) return Reference::potential_temperature;
  if (scalar == "total_water_mass_fraction") return Reference::total_water;
  return Reference::none;
}

constexpr std::array<const char*, 4> vorticities = {"vorticity", "x_vorticity", "y_vorticity",
                                                    "z_vorticity"};

constexpr std::array<const char*, 3> reference_names = {
    "reference_buoyancy", "reference_potential_temperature", "reference_total_water"};

/// One quantity during a pass: its values, and what is relaxed if that is something else.
struct Relaxed {
  double* values = nullptr;
  const double* gathered_from = nullptr;  // the values, or their perturbations
};

constexpr std::size_t widest = 8;

class GridNudging : public Operator<GridNudging> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    describe_parameters(d);
    strain_ = d.reads_mesh("strain_rate_magnitude", "s-1").doc("of the gridded flow");
    height_ = d.reads("height", "m").doc("where the reference profiles are taken");
    for (std::size_t i = 0; i < mixed_scalars.size(); ++i)
      scalar_[i] = d.updates(mixed_scalars[i].name, mixed_scalars[i].units)
                       .optional()
                       .doc("mixed if carried");
    for (std::size_t i = 0; i < vorticities.size(); ++i)
      vorticity_[i] = d.updates(vorticities[i], "s-1")
                          .optional()
                          .when("mix_vorticity == true")
                          .doc("mixed on request");
  }

  void configured() {
    mesh_ = Mesh(host());
    for (std::size_t r = 0; r < profiles_.size(); ++r)
      profiles_[r] = profile_of_lists({"reference_height", list(reference_height_)},
                                      {reference_names[r], list(reference_[r])});
  }

  void apply(const pileus_step& step, Block block) const {
    if (value(beta_) > 0) mix(step, block, scalar_, value(beta_), true);
    if (is_on(mix_vorticity_) && value(beta_vorticity_) > 0)
      mix(step, block, vorticity_, value(beta_vorticity_), false);
  }

 private:
  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.grid_nudging";
    d.op.kind = "mixing";
    d.op.version = "1.0.0";
    d.op.title = "Grid nudging";
    d.op.summary =
        "Relaxes parcels towards the gridded value at the rate of the strain, conserving and "
        "monotone for any time step.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("small_scale_mixing");
    d.cites("10.1016/j.jcpx.2023.100136", "Frey et al. 2023: EPIC, whose damping this follows");
  }

  void describe_parameters(Declaration& d) {
    static constexpr double ladder[] = {0.0, 0.1, 0.3,
                                        1.0, 3.0, std::numeric_limits<double>::quiet_NaN()};
    beta_ = d.number("beta", "1", 0.3)
                .range(0.0, 100.0)
                .knob(ladder)
                .doc("relaxation rate of scalars over the strain rate |S|");
    mix_vorticity_ = d.toggle("mix_vorticity", false).doc("whether vorticity is relaxed too");
    beta_vorticity_ = d.number("beta_vorticity", "1", 0.3)
                          .range(0.0, 100.0)
                          .when("mix_vorticity == true")
                          .doc("the same for vorticity");
    reference_height_ = d.numbers("reference_height", "m", 0.0)
                            .range(-1e6, 1e6)
                            .doc("heights of the profiles that perturbations are measured from");
    reference_[0] = d.numbers(reference_names[0], "m s-2", 0.0)
                        .range(-1e4, 1e4)
                        .doc("profile of the buoyancy, or of the liquid-water buoyancy");
    reference_[1] = d.numbers(reference_names[1], "K", 0.0)
                        .range(0.0, 2000.0)
                        .doc("profile of the potential temperature in use");
    reference_[2] =
        d.numbers(reference_names[2], "1", 0.0).range(0.0, 1.0).doc("profile of the total water");
  }

  /// Relaxes the given quantities in passes of as many as fit beside the share in one record.
  template <std::size_t N>
  void mix(const pileus_step& step, Block block, const std::array<Slot, N>& slots, double beta,
           bool with_references) const {
    std::array<Relaxed, widest> pass;
    std::size_t count = 0;
    const std::size_t most = mesh_.width() - 1;
    for (std::size_t i = 0; i < N; ++i) {
      if (!block.has(slots[i])) continue;
      Relaxed& r = pass[count++];
      r.values = block.out(slots[i]);
      const Reference reference =
          with_references ? reference_of(mixed_scalars[i].name) : Reference::none;
      r.gathered_from = perturbation(block, r.values, reference);
      if (count == most) {
        relax(step, block, {pass.data(), count}, beta);
        count = 0;
      }
    }
    if (count > 0) relax(step, block, {pass.data(), count}, beta);
  }

  /// Values less their reference profile; the values themselves where that is zero everywhere.
  const double* perturbation(Block block, const double* values, Reference reference) const {
    if (reference == Reference::none) return values;
    const PiecewiseLinear& profile = profiles_[static_cast<std::size_t>(reference)];
    if (profile.is_zero()) return values;
    const double* z = block.in(height_);
    double* result = block.scratch(static_cast<std::size_t>(block.count())).data();
    parallel_for(block.count(), [&](std::int64_t p) { result[p] = values[p] - profile(z[p]); });
    return result;
  }

  void relax(const pileus_step& step, Block block, std::span<Relaxed> pass, double beta) const {
    const auto parcels = static_cast<std::size_t>(block.count());
    const std::size_t width = mesh_.width();
    std::array<const double*, widest> from{};
    std::array<double*, widest> at_parcels{};
    for (std::size_t f = 0; f < pass.size(); ++f) from[f] = pass[f].gathered_from;
    double* field = block.scratch(mesh_.field_size()).data();
    mesh_.deposit(block.count(), {from.data(), pass.size()}, field);
    const auto strain = block.strided_in<double>(strain_);
    parallel_for(static_cast<std::int64_t>(mesh_.nodes()), [&](std::int64_t node) {
      double* record = field + static_cast<std::size_t>(node) * width;
      record[0] = numerics::relaxed_part(beta * strain(node) * step.dt);
      for (std::size_t f = 0; f < pass.size(); ++f) record[1 + f] *= record[0];
    });
    for (std::size_t f = 0; f <= pass.size(); ++f) at_parcels[f] = block.scratch(parcels).data();
    mesh_.interpolate(block.count(), field, {at_parcels.data(), pass.size() + 1});
    for (std::size_t f = 0; f < pass.size(); ++f)
      move(block, pass[f], at_parcels[0], at_parcels[1 + f]);
  }

  void move(Block block, const Relaxed& r, const double* share, const double* gathered) const {
    const double low = *std::min_element(r.gathered_from, r.gathered_from + block.count());
    const double high = *std::max_element(r.gathered_from, r.gathered_from + block.count());
    parallel_for(block.count(), [&](std::int64_t p) {
      const double before = r.gathered_from[p];
      if (share[p] == 0) return;
      // The bounds take away rounding alone.
      if (r.gathered_from == r.values) {
        r.values[p] = std::clamp(nudged(before, gathered[p], share[p]), low, high);
      } else {
        r.values[p] += std::clamp(nudging_increment(before, gathered[p], share[p]), low - before,
                                  high - before);
      }
    });
  }

  Slot strain_, height_;
  std::array<Slot, mixed_scalars.size()> scalar_;
  std::array<Slot, vorticities.size()> vorticity_;
  Param beta_, mix_vorticity_, beta_vorticity_, reference_height_;
  std::array<Param, 3> reference_;
  std::array<PiecewiseLinear, 3> profiles_;
  Mesh mesh_;
};

}  // namespace
}  // namespace pileus::nudging

PILEUS_PLUGIN(pileus::nudging::GridNudging, "org.pileus.grid_nudging", "1.0.0");

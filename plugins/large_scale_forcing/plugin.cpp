// What the large scale does to a small domain: subsidence, tendencies, the mean wind and a sponge,
// as changes of the levels' means that are given to the parcels.
#include <pileus/mesh.hpp>
#include <pileus/numerics.hpp>

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "column_forcing.hpp"
#include "level_sources.hpp"
#include "parameters.hpp"
#include "quantities.hpp"

namespace pileus::large_scale {
namespace {

/// A quantity of the parcels during one call.
struct Subject {
  Change change;
  int scalar = -1;     // position in mixed_scalars
  int vorticity = -1;  // position among the components of the vorticity
};

constexpr std::size_t most_subjects = scalar_count + 3;

struct Subjects {
  std::array<Subject, most_subjects> list;
  std::array<const double*, most_subjects> values{};
  std::size_t count = 0;

  void add(const Subject& subject) {
    values[count] = subject.change.values;
    list[count++] = subject;
  }
  std::size_t of_vorticity(std::size_t component) const {
    std::size_t i = 0;
    while (list[i].vorticity != static_cast<int>(component)) ++i;
    return i;
  }
};

class LargeScaleForcing : public Operator<LargeScaleForcing> {
 public:
  void describe(Declaration& d) {
    d.op.id = "org.pileus.large_scale_forcing";
    d.op.kind = "forcing";
    d.op.version = "1.0.0";
    d.op.title = "Large-scale forcing";
    d.op.summary =
        "Subsidence, tendencies, nudged or geostrophic mean wind and a sponge, from profiles over "
        "height, with closed budgets.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("large_scale_forcing");
    d.cites("10.1175/1520-0469(2003)60<1201:ALESIS>2.0.CO;2",
            "Siebesma et al. 2003: forcing of trade-wind cumulus, which this expresses");
    parameters_.describe(d);
    quantities_.describe(d);
  }

  void configured() {
    [[maybe_unused]] const Mesh required(host());  // refuses a run without one
    const Parameters& p = parameters_;
    given_.subsidence = profile(p.subsidence_velocity);
    given_.temperature = profile(p.temperature_tendency);
    given_.total_water = profile(p.water_tendency);
    given_.buoyancy = profile(p.buoyancy_tendency);
    given_.sponge = profile(p.sponge_rate);
    given_.target = {profile(p.target_x), profile(p.target_y)};
    given_.push = {profile(p.push_x), profile(p.push_y)};
    pushes_ = !given_.push.x.is_zero() || !given_.push.y.is_zero();
    given_.geostrophic = {profile(p.geostrophic_x), profile(p.geostrophic_y)};
    subsides_ = !given_.subsidence.is_zero();
    wind_subsides_ = subsides_ && choice(p.subsidence_of) == 1;
    sponge_ = !given_.sponge.is_zero();
    scalar_sponge_ = sponge_ && choice(p.sponge_of) == 1;
    nudges_ = value(p.wind_nudging_time) > 0;
    geostrophic_ = is_on(p.geostrophic);
  }

  double prepare(const pileus_step&, Block block) {
    if (!forcing_.is_built()) {
      check(block);
      const pileus_grid& grid = *block.raw().grid;
      const double ground =
          grid.spacing[0] * static_cast<double>(grid.cells[0]) *
          (grid.dimension == 3 ? grid.spacing[1] * static_cast<double>(grid.cells[1]) : 1.0);
      forcing_ = ColumnForcing(
          given_, {grid.origin[2], grid.spacing[2], static_cast<std::size_t>(grid.cells[2])},
          ground);
    }
    return forcing_.longest_step();
  }

  void apply(const pileus_step& step, Block block) const {
    const Column parcels{block.in(quantities_.height), block.in(quantities_.volume), block.count()};
    Subjects subjects = collect(block);
    if (subjects.count == 0) return;
    const auto in_chunks = [this](std::int64_t n, std::int64_t grain, auto&& body) {
      parallel_chunks(n, grain, body);
    };
    const Levels& levels = forcing_.levels;
    const LevelMeans means(levels, parcels, {subjects.values.data(), subjects.count},
                           block.scratch(LevelMeans::room(levels, parcels.count, subjects.count)),
                           in_chunks);
    std::array<double, budget_names.size()> brought{};
    force_scalars(step, block, means, subjects, brought);
    if (acts_on_wind()) force_wind(step, block, means, subjects);
    if (sponge_) damp(step, block, means, subjects);
    carry_out_all(block, parcels, subjects, brought);
    for (const Subject& subject : std::span(subjects.list).first(subjects.count))
      expect_in_range(block, slot_of(subject),
                      "the large-scale forcing takes the air beyond what air can be; take shorter "
                      "steps or a weaker forcing");
    for (std::size_t b = 0; b < brought.size(); ++b)
      if (brought[b] != 0) block.book(quantities_.budget[b], brought[b]);
  }

 private:
  Slot slot_of(const Subject& subject) const {
    return subject.scalar >= 0 ? quantities_.scalar[static_cast<std::size_t>(subject.scalar)]
                               : quantities_.vorticity[static_cast<std::size_t>(subject.vorticity)];
  }
  bool acts_on_wind() const { return pushes_ || nudges_ || geostrophic_ || wind_subsides_; }

  /// Refuses what is asked of quantities that the run does not have.
  void check(const Block& block) const {
    const Receivers receivers(quantities_, block);
    if (!given_.temperature.is_zero() && receivers.temperature < 0 && receivers.buoyancy < 0)
      throw Failure(
          "potential_temperature_tendency needs a potential temperature or a buoyancy, and the "
          "parcels carry neither; set liquid_water_potential_temperature in the scene's initial "
          "section or leave the tendency out",
          PILEUS_E_CONFIG);
    if (!given_.total_water.is_zero() && receivers.water < 0)
      throw Failure(
          "total_water_tendency needs total_water_mass_fraction or specific_humidity, and the "
          "parcels carry neither; set one in the scene's initial section or leave the tendency out",
          PILEUS_E_CONFIG);
    if (!given_.buoyancy.is_zero() && receivers.buoyancy < 0)
      throw Failure(
          "buoyancy_tendency needs liquid_water_buoyancy or buoyancy, and the parcels carry "
          "neither; give potential_temperature_tendency instead",
          PILEUS_E_CONFIG);
    // Heating of buoyancy is times g/θ_00.
    if (!given_.temperature.is_zero() && receivers.temperature < 0 &&
        value(parameters_.gravity) == 0)
      throw Failure(
          "potential_temperature_tendency does nothing: parcels carry a buoyancy, which heating "
          "changes by gravity/reference_temperature, and gravity is 0",
          PILEUS_E_CONFIG);
    if (Quantities::is_plane(block)) check_plane();
    if (geostrophic_ &&
        (!block.has(quantities_.coriolis) || block.in(quantities_.coriolis)[0] == 0))
      throw Failure(
          "geostrophic is on, but the run does not rotate: set background.coriolis or "
          "background.latitude of a three-dimensional scene, or switch it off",
          PILEUS_E_CONFIG);
  }

  void check_plane() const {
    if (!given_.target.y.is_zero())
      throw Failure("target_y_velocity is not zero, but a plane run has no wind in y; leave it out",
                    PILEUS_E_CONFIG);
    if (!given_.push.y.is_zero())
      throw Failure("y_wind_tendency is not zero, but a plane run has no wind in y; leave it out",
                    PILEUS_E_CONFIG);
  }

  /// What this call changes, without what happens to it.
  Subjects collect(const Block& block) const {
    Subjects subjects;
    for (std::size_t i = 0; i < scalar_count; ++i) {
      if (!block.has(quantities_.scalar[i])) continue;
      if (!subsides_ && !scalar_sponge_ && !has_tendency(block, static_cast<int>(i))) continue;
      Subject subject;
      subject.scalar = static_cast<int>(i);
      subject.change.values = block.out(quantities_.scalar[i]);
      subject.change.sharing = traits_of(mixed_scalars[i].name).sharing;
      subjects.add(subject);
    }
    if (!acts_on_wind() && !sponge_) return subjects;
    for (std::size_t i = 0; i < quantities_.vorticity.size(); ++i) {
      if (!block.has(quantities_.vorticity[i])) continue;
      Subject subject;
      subject.vorticity = static_cast<int>(i);
      subject.change.values = block.out(quantities_.vorticity[i]);
      subjects.add(subject);
    }
    return subjects;
  }

  bool has_tendency(const Block& block, int scalar) const {
    const Receivers to(quantities_, block);
    const bool heats_buoyancy = to.temperature < 0 && !given_.temperature.is_zero();
    return (scalar == to.temperature && !given_.temperature.is_zero()) ||
           (scalar == to.water && !given_.total_water.is_zero()) ||
           (scalar == to.buoyancy && (heats_buoyancy || !given_.buoyancy.is_zero()));
  }

  double* zeros(const Block& block) const {
    double* levels = block.scratch(forcing_.levels.count()).data();
    std::fill_n(levels, forcing_.levels.count(), 0.0);
    return levels;
  }

  /// ∫ S w_k dz of all that is given to a scalar, per second.
  void gather_sources(const Block& block, const LevelMeans& means, std::size_t subject, int scalar,
                      double* sources) const {
    const Receivers to(quantities_, block);
    const auto add = [&](const std::vector<double>& integrals, double factor) {
      for (std::size_t k = 0; k < integrals.size(); ++k) sources[k] += factor * integrals[k];
    };
    if (scalar == to.temperature) add(forcing_.temperature, 1.0);
    if (scalar == to.water) add(forcing_.total_water, 1.0);
    if (scalar == to.buoyancy) {
      add(forcing_.buoyancy, 1.0);
      if (to.temperature < 0)
        add(forcing_.temperature,
            value(parameters_.gravity) / value(parameters_.reference_temperature));
    }
    if (subsides_) add_subsidence(forcing_.levels, means, subject, forcing_.subsidence, sources);
  }

  /// Sources of the scalars as increments of the levels; adds what they bring to the budgets.
  void force_scalars(const pileus_step& step, const Block& block, const LevelMeans& means,
                     Subjects& subjects, std::span<double> brought) const {
    for (std::size_t s = 0; s < subjects.count; ++s) {
      Subject& subject = subjects.list[s];
      if (subject.scalar < 0) continue;
      const bool in_proportion = subject.change.sharing == Sharing::in_proportion;
      double* levels = zeros(block);
      gather_sources(block, means, s, subject.scalar, levels);
      double amount = 0;
      for (std::size_t k = 0; k < forcing_.levels.count(); ++k) {
        const double source = levels[k] * forcing_.area * step.dt;
        levels[k] = 0;
        if (means.is_empty(k)) continue;
        double increment = source / means.volume(k);
        if (in_proportion) {
          const double mean = means.mean(k, s);
          levels[k] = mean > 0 ? std::max(increment / mean, -1.0) : 0.0;
          increment = levels[k] * mean;
        } else {
          levels[k] = increment;
        }
        amount += increment * means.volume(k);
      }
      subject.change.increments = levels;
      const int budget =
          traits_of(mixed_scalars[static_cast<std::size_t>(subject.scalar)].name).budget;
      if (budget >= 0) brought[static_cast<std::size_t>(budget)] += amount;
    }
  }

  /// Every force on the mean wind as changes of the levels' shear and of the mean over the domain.
  void force_wind(const pileus_step& step, const Block& block, const LevelMeans& means,
                  Subjects& subjects) const {
    const Levels& levels = forcing_.levels;
    const std::size_t components = Quantities::wind_components(block);
    std::array<double*, 2> gain{};
    std::array<double, 2> mean_gain{};
    for (std::size_t c = 0; c < components; ++c) {
      gain[c] = zeros(block);
      const WindComponent wind = Quantities::wind(block, c);
      double* shear = block.scratch(levels.count()).data();
      const std::size_t subject = subjects.of_vorticity(wind.vorticity);
      for (std::size_t k = 0; k < levels.count(); ++k)
        shear[k] = wind.sign * means.mean(k, subject);
      if (wind_subsides_) mean_gain[c] += sink_wind(step.dt, shear, gain[c]);
      if (pushes_) {
        for (std::size_t k = 0; k < levels.count(); ++k)
          gain[c][k] += step.dt * forcing_.push.shear[c][k];
        mean_gain[c] += step.dt * forcing_.push.mean[c];
      }
      if (nudges_)
        mean_gain[c] += nudge(step.dt, c, shear, block.in(quantities_.mean_wind[c])[0], gain[c]);
    }
    if (geostrophic_) push_geostrophic(step.dt, block.in(quantities_.coriolis)[0], gain, mean_gain);
    for (std::size_t c = 0; c < components; ++c) {
      const WindComponent wind = Quantities::wind(block, c);
      for (std::size_t k = 0; k < levels.count(); ++k) gain[c][k] *= wind.sign;
      subjects.list[subjects.of_vorticity(wind.vorticity)].change.increments = gain[c];
      block.out(quantities_.mean_wind[c])[0] += mean_gain[c];
    }
  }

  /// Adds to the shear what subsidence does to the wind; returns the gain of its mean.
  double sink_wind(double dt, const double* shear, double* gain) const {
    const Levels& levels = forcing_.levels;
    const double force =
        add_wind_subsidence(levels, shear, forcing_.subsidence, forcing_.subsidence_at_bottom,
                            forcing_.subsidence_at_top, gain);
    for (std::size_t k = 0; k < levels.count(); ++k) gain[k] *= dt / levels.length(k);
    return dt * force / levels.depth();
  }

  double nudge(double dt, std::size_t component, const double* shear, double mean,
               double* gain) const {
    const double part = numerics::relaxed_part(1.0 / value(parameters_.wind_nudging_time) * dt);
    for (std::size_t k = 0; k < forcing_.levels.count(); ++k)
      gain[k] += part * (forcing_.target.shear[component][k] - shear[k]);
    return part * (forcing_.target.mean[component] - mean);
  }

  void push_geostrophic(double dt, double coriolis, std::array<double*, 2> gain,
                        std::array<double, 2>& mean_gain) const {
    const GeostrophicPush push(coriolis, dt);
    const LevelWind& wind = forcing_.geostrophic;
    for (std::size_t k = 0; k < forcing_.levels.count(); ++k) {
      gain[0][k] += push.x(wind.shear[0][k], wind.shear[1][k]);
      gain[1][k] += push.y(wind.shear[0][k], wind.shear[1][k]);
    }
    mean_gain[0] += push.x(wind.mean[0], wind.mean[1]);
    mean_gain[1] += push.y(wind.mean[0], wind.mean[1]);
  }

  void damp(const pileus_step& step, const Block& block, const LevelMeans& means,
            Subjects& subjects) const {
    double* parts = zeros(block);
    for (std::size_t k = 0; k < forcing_.levels.count(); ++k)
      parts[k] = numerics::relaxed_part(forcing_.sponge[k] * step.dt);
    for (std::size_t s = 0; s < subjects.count; ++s) {
      Subject& subject = subjects.list[s];
      if (subject.scalar >= 0 && !scalar_sponge_) continue;
      subject.change.relaxed_part = parts;
      subject.change.target = zeros(block);
      for (std::size_t k = 0; k < forcing_.levels.count(); ++k)
        subject.change.target[k] = means.mean(k, s);
    }
  }

  /// One pass over the parcels; what is cut counts as brought in.
  void carry_out_all(const Block& block, const Column& parcels, const Subjects& subjects,
                     std::span<double> brought) const {
    const std::size_t chunks = chunks_of(parcels.count);
    const std::size_t width = 2 * subjects.count;
    double* cut = block.scratch(chunks * width).data();
    parallel_chunks(parcels.count, chunk_size, [&](std::int64_t begin, std::int64_t end) {
      double* own = cut + static_cast<std::size_t>(begin / chunk_size) * width;
      for (std::size_t s = 0; s < subjects.count; ++s) {
        const Cuts cuts = carry_out(subjects.list[s].change, forcing_.levels, parcels, begin, end);
        own[2 * s] = cuts.amount;
        own[2 * s + 1] = cuts.count;
      }
    });
    double repairs = 0;
    for (std::size_t s = 0; s < subjects.count; ++s) {
      const int scalar = subjects.list[s].scalar;
      if (scalar < 0) continue;
      const int budget = traits_of(mixed_scalars[static_cast<std::size_t>(scalar)].name).budget;
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        if (budget >= 0) brought[static_cast<std::size_t>(budget)] += cut[chunk * width + 2 * s];
        repairs += cut[chunk * width + 2 * s + 1];
      }
    }
    block.repaired(static_cast<std::uint64_t>(repairs));
  }

  Parameters parameters_;
  Quantities quantities_;
  Profiles given_;
  ColumnForcing forcing_;
  bool subsides_ = false, wind_subsides_ = false, sponge_ = false, scalar_sponge_ = false;
  bool pushes_ = false, nudges_ = false, geostrophic_ = false;
};

}  // namespace
}  // namespace pileus::large_scale

PILEUS_PLUGIN(pileus::large_scale::LargeScaleForcing, "org.pileus.large_scale_forcing", "1.0.0");

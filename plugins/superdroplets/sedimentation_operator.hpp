// The operator that lets droplets fall through their parcels, to others and to the ground.
#pragma once
#include <pileus/plugin.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cell_lists.hpp"
#include "coalescence_operator.hpp"
#include "droplet_quantities.hpp"
#include "fall_speed_table.hpp"
#include "sedimentation.hpp"

namespace pileus::superdroplets {

class SedimentationOperator : public Operator<SedimentationOperator> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    CoalescenceOperator::describe_fall_speed(d, fall_speed_, temperature_, pressure_);
    ground_ =
        d.number("ground", "m", -1e6)
            .range(-1e6, 1e6)
            .doc("height at which drops are on the ground, where the domain reaches below it");
    least_radius_ = d.number("smallest_falling_radius", "m", 0.0)
                        .range(0.0, 1e-2)
                        .doc(
                            "smaller droplets stay in their parcels: they fall less than a parcel "
                            "in the life of "
                            "a cloud, and moving them as a whole is noise");
    x_ = d.reads("x_position", "m");
    y_ = d.reads("y_position", "m").doc("does not exist in two dimensions");
    z_ = d.reads("height", "m");
    shape_ = d.reads("shape_zz", "m2").doc("its root is the parcel's vertical half-extent");
    volume_ = d.reads("parcel_volume", "m3");
    multiplicity_ = d.updates_of_items(multiplicity_name, "1")
                        .type(PILEUS_I64)
                        .range(0.0, largest_multiplicity);
    water_ = d.updates_of_items(water_mass_name, "kg")
                 .of_each(multiplicity_name, water_budget)
                 .range(0.0, heaviest_drop);
    dry_ = d.updates_of_items(dry_volume_name, "m3")
               .of_each(multiplicity_name, aerosol_budget)
               .range(0.0, largest_particle)
               .optional();
    place_ = d.owns_of_items(height_name, "1").label().range(-1e9, 1e9);
    fallen_ = d.accumulates("rainfall_amount", "kg m-2").range(0.0, 1e6);
    fallen_drops_ = d.accumulates("raindrop_number_at_surface", "m-2").range(0.0, 1e18);
    water_ledger_ = d.budget(water_budget);
    aerosol_ledger_ = d.budget(aerosol_budget);
  }

  void configured() {
    table_ = FallSpeedTable(static_cast<FallSpeedScheme>(choice(fall_speed_)), value(temperature_),
                            value(pressure_));
    least_mass_ = drops::mass_of_radius(value(least_radius_));
  }

  /// Droplets start anywhere in their parcels.
  void init(const pileus_step& step, Block block) {
    double* place = block.out(place_);
    const pileus_grid* grid = block.raw().grid;
    parallel_for(block.count(), [&](std::int64_t p) {
      constexpr std::int64_t per_channel = 65536;
      const std::int64_t begin = block.item_begin(p), end = block.item_end(p);
      std::vector<double> draws(static_cast<std::size_t>(std::min(per_channel, end - begin)));
      for (std::int64_t first = begin; first < end; first += per_channel) {
        const std::int64_t n = std::min(per_channel, end - first);
        const auto channel = static_cast<std::uint32_t>((first - begin) / per_channel);
        draw(step, block.uid(p), channel, static_cast<std::uint32_t>(n), draws.data());
        for (std::int64_t k = 0; k < n; ++k) {
          const double s = random_relative_height(draws[static_cast<std::size_t>(k)]);
          place[first + k] = grid == nullptr ? s : above(ground_of(*grid), s, span_of(block, p));
        }
      }
    });
  }

  void apply(const pileus_step& step, Block block) const {
    const pileus_grid* grid = block.raw().grid;
    if (grid == nullptr) throw Failure("droplets cannot fall without a mesh");
    constexpr std::int64_t grain = 2048;
    std::vector<std::vector<Leaver>> leavers(
        static_cast<std::size_t>((block.count() + grain - 1) / grain));
    parallel_chunks(block.count(), grain, [&](std::int64_t begin, std::int64_t end) {
      std::vector<Leaver>& mine = leavers[static_cast<std::size_t>(begin / grain)];
      for (std::int64_t p = begin; p < end; ++p)
        fall_within(step, block, p, ground_of(*grid), mine);
    });
    if (std::any_of(leavers.begin(), leavers.end(), [](const auto& l) { return !l.empty(); }))
      hand_over(step, block, *grid, leavers);
  }

 private:
  /// Drops of an item on their way from one parcel to the next.
  struct Leaver {
    std::int64_t item, parcel;
    std::uint32_t number;  // of the item in its list
    double height;         // where they leave, m
    double distance;       // left to fall in this step, m
    double volume = 0;     // of the parcel they leave, m3
    std::int64_t drops = 0;
  };
  struct Arrival {
    std::int64_t parcel, item, drops;
    double place;
  };
  /// Placing drops at the start has taken the draws of number 0.
  static constexpr std::uint32_t first_draw = 1;
  /// Marks the place of a drop that has left.
  static constexpr double gone = -1e8;

  double ground_of(const pileus_grid& grid) const {
    return std::max(grid.origin[2], value(ground_));
  }

  /// Parcels at the ground reach below it by their shape alone; the air of that part is above.
  static double above(double ground, double place, const ParcelSpan& parcel) {
    const double height = height_of(place, parcel);
    return height < ground ? relative_height_in(parcel, 2.0 * ground - height) : place;
  }

  ParcelSpan span_of(const Block& block, std::int64_t p) const {
    return {block.in(z_)[p], std::sqrt(block.in(shape_)[p]), block.in(volume_)[p]};
  }

  /// Three draws for the way of an item of a parcel out of the parcel it has got to.
  static std::array<double, 3> draws(const pileus_step& step, std::uint64_t uid,
                                     std::uint32_t number, std::uint32_t crossing) {
    const std::uint32_t channel = number / 65536 % 64;
    const DrawKey key{step.seed, step.stream, uid, step.number, step.call, channel};
    const auto key_words = philox_key(step.seed, step.stream ^ (crossing * 0x9E3779B1u));
    const auto words = philox4x32(philox_counter(key, number % 65536), key_words);
    const double rounding = (static_cast<double>(words[1]) + 0.5) * 0x1p-32;
    return {open_unit_interval(0, words[0]), open_unit_interval(words[2], words[3]), rounding};
  }

  /// Lowers the drops of a parcel; those that leave are listed.
  void fall_within(const pileus_step& step, const Block& block, std::int64_t p, double ground,
                   std::vector<Leaver>& leavers) const {
    const double* water = block.in(water_);
    double* place = block.out(place_);
    const ParcelSpan parcel = span_of(block, p);
    const double inverse = 1.0 / parcel.half_extent;
    std::uint32_t number = 0;
    for (std::int64_t i = block.item_begin(p); i < block.item_end(p); ++i, ++number) {
      if (water[i] < least_mass_) continue;
      const double distance = table_(water[i]).speed * step.dt;
      const double start = above(ground, place[i], parcel), end = start - distance * inverse;
      if (!(height_of(end, parcel) > ground)) {
        leavers.push_back({i, p, number, ground, 0.0, 0.0, 0});
        place[i] = gone;
        continue;
      }
      if (end < 0) {
        const double exit = exit_height(start, draws(step, block.uid(p), number, first_draw)[0]);
        if (exit >= end) {
          const double left = distance - (start - exit) * parcel.half_extent;
          leavers.push_back({i, p, number, height_of(exit, parcel), std::max(0.0, left), 0.0, 0});
          place[i] = gone;
          continue;
        }
      }
      place[i] = end;
    }
  }

  /// Parcels of a column whose centre is within two cells of a height.
  struct Candidates {
    std::vector<ParcelSpan> spans;
    std::vector<std::uint32_t> parcels;
    void find(const SedimentationOperator& op, const Block& block, const CellLists& cells,
              std::size_t column, double height) {
      constexpr std::size_t reach = 2;
      spans.clear();
      parcels.clear();
      const std::size_t k = cells.level_of(height);
      const std::size_t low = k > reach ? k - reach : 0;
      const std::size_t high = std::min(cells.levels() - 1, k + reach);
      for (std::size_t level = low; level <= high; ++level)
        for (const std::uint32_t q : cells.parcels(column * cells.levels() + level)) {
          spans.push_back(op.span_of(block, q));
          parcels.push_back(q);
        }
    }
  };

  /// Follows every leaver through the parcels below until it has fallen its distance.
  void hand_over(const pileus_step& step, const Block& block, const pileus_grid& grid,
                 const std::vector<std::vector<Leaver>>& leavers) const {
    const double *x = block.in(x_), *y = block.has(y_) ? block.in(y_) : nullptr;
    const CellLists cells(grid, static_cast<std::size_t>(block.count()), x, y, block.in(z_));
    std::vector<Arrival> arrivals;
    Candidates candidates;
    std::vector<Leaver> on_their_way;
    for (const std::vector<Leaver>& some : leavers)
      for (const Leaver& item : some) {
        const Column column{cells, grid,
                            cells.column_of(x[item.parcel], y != nullptr ? y[item.parcel] : 0.0)};
        on_their_way.assign(1, item);
        on_their_way.back().volume = block.in(volume_)[item.parcel];
        on_their_way.back().drops = block.whole_in(multiplicity_)[item.item];
        std::uint32_t draw = first_draw;
        while (!on_their_way.empty())
          cross(step, block, column, ++draw, candidates, on_their_way, arrivals);
      }
    regroup(block, arrivals);
  }

  struct Column {
    const CellLists& cells;
    const pileus_grid& grid;
    std::size_t number;
  };

  /// Lets the last of the leavers enter a parcel, or a part of its drops.
  void cross(const pileus_step& step, const Block& block, const Column& column, std::uint32_t draw,
             Candidates& candidates, std::vector<Leaver>& waiting,
             std::vector<Arrival>& arrivals) const {
    Leaver& from = waiting.back();
    if (!(from.height > ground_of(column.grid))) {
      land(block, column, from.item, from.drops);
      waiting.pop_back();
      return;
    }
    candidates.find(*this, block, column.cells, column.number, from.height);
    const auto u = draws(step, block.uid(from.parcel), from.number, draw);
    const Receiver to = choose_receiver(from.height, candidates.spans, from.volume, u[0]);
    if (!to.reaches) return fall_freely(block, column, candidates, waiting, arrivals);
    const ParcelSpan& parcel = candidates.spans[to.parcel];
    Leaver part = from;
    part.volume = std::min(from.volume, parcel.volume);
    if (to.share < 1) {  // rounded by chance: on average each parcel gets what is due to it
      const double wanted = std::floor(to.share * static_cast<double>(from.drops) + u[2]);
      part.drops = std::min(from.drops, static_cast<std::int64_t>(wanted));
      if (part.drops == 0 && draw < most_crossings) return;
    }
    from.drops -= part.drops;
    if (from.drops == 0) waiting.pop_back();
    const double end = to.relative_height - part.distance / parcel.half_extent;
    const double exit = exit_height(to.relative_height, u[1]);
    const double lowest = height_of(std::max(exit, end), parcel);
    if (!(lowest > ground_of(column.grid))) {
      land(block, column, part.item, part.drops);
      return;
    }
    if (exit < end || draw >= most_crossings) {
      arrivals.push_back({candidates.parcels[to.parcel], part.item, part.drops, end});
      return;
    }
    const double fallen = (to.relative_height - exit) * parcel.half_extent;
    part.height -= fallen;
    part.distance = std::max(0.0, part.distance - fallen);
    waiting.push_back(part);
  }

  /// No parcel reaches the last of the leavers: it falls to the next below, or ends on the way, in
  /// the care of the nearest.
  void fall_freely(const Block& block, const Column& column, const Candidates& candidates,
                   std::vector<Leaver>& waiting, std::vector<Arrival>& arrivals) const {
    constexpr double inside = 1e-9;  // of a half-extent below the top of the next
    Leaver& drop = waiting.back();
    double next = drop.height - column.grid.spacing[2];
    for (const ParcelSpan& parcel : candidates.spans) {
      const double top = parcel.height + (1.0 - inside) * parcel.half_extent;
      if (top < drop.height) next = std::max(next, top);
    }
    const double end = drop.height - drop.distance;
    const double ground = ground_of(column.grid);
    if (std::max(next, end) <= ground) {
      land(block, column, drop.item, drop.drops);
      waiting.pop_back();
    } else if (end < next) {
      drop.distance -= drop.height - next;
      drop.height = next;
    } else {
      const ParcelSpan owner = span_of(block, drop.parcel);
      arrivals.push_back({drop.parcel, drop.item, drop.drops, relative_height_in(owner, end)});
      waiting.pop_back();
    }
  }

  /// What reaches the ground leaves the air, with what it carries.
  void land(const Block& block, const Column& column, std::int64_t item, std::int64_t drops) const {
    const auto number = static_cast<double>(drops);
    const pileus_grid& grid = column.grid;
    const double area = grid.spacing[0] * (grid.dimension == 3 ? grid.spacing[1] : 1.0);
    const double water = number * block.in(water_)[item];
    block.accumulator(fallen_)[column.number] += water / area;
    block.accumulator(fallen_drops_)[column.number] += number / area;
    const double scale = item_budget_scale();
    block.book(water_ledger_, -water / scale);
    if (block.has(dry_)) block.book(aerosol_ledger_, -number * block.in(dry_)[item] / scale);
  }

  /// New lists: what stays, in its order, and what arrives behind it.
  void regroup(const Block& block, std::vector<Arrival>& arrivals) const {
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const Arrival& a, const Arrival& b) { return a.parcel < b.parcel; });
    const double* place = block.in(place_);
    const std::int64_t* multiplicity = block.whole_in(multiplicity_);
    std::vector<std::int32_t> count(static_cast<std::size_t>(block.count()));
    std::vector<std::int64_t> source;
    source.reserve(static_cast<std::size_t>(block.elements(multiplicity_)) + arrivals.size());
    std::vector<std::size_t> arrived;  // where, in the new lists
    arrived.reserve(arrivals.size());
    auto next = arrivals.begin();
    for (std::int64_t p = 0; p < block.count(); ++p) {
      const std::size_t before = source.size();
      for (std::int64_t i = block.item_begin(p); i < block.item_end(p); ++i)
        if (place[i] != gone && multiplicity[i] != 0) source.push_back(i);
      for (; next != arrivals.end() && next->parcel == p; ++next) {
        arrived.push_back(source.size());
        source.push_back(next->item);
      }
      count[static_cast<std::size_t>(p)] = static_cast<std::int32_t>(source.size() - before);
    }
    regroup_items(block, count, source);
    double* new_place = block.out(place_);
    std::int64_t* new_multiplicity = block.whole_out(multiplicity_);
    for (std::size_t k = 0; k < arrivals.size(); ++k) {
      new_place[arrived[k]] = arrivals[k].place;
      new_multiplicity[arrived[k]] = arrivals[k].drops;
    }
  }

  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.superdroplets.sedimentation";
    d.op.kind = "microphysics";
    d.op.version = "1.0.0";
    d.op.title = "Fall of superdroplets between parcels";
    d.op.summary =
        "Every droplet falls at its own speed within its parcel, on to the parcels below, and to "
        "the ground.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.op.flags = PILEUS_RANDOM | PILEUS_RESIZES_ITEMS;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("droplet_sedimentation");
    d.requires_effect("size_resolved_droplets");
    d.cites("10.1175/1520-0469(1976)033<0851:TVASOC>2.0.CO;2", "Beard 1976: fall speeds");
  }

  /// A drop that has crossed so many parcels in one step is put where it ends by its height alone.
  static constexpr std::uint32_t most_crossings = 4096;

  Param fall_speed_, temperature_, pressure_, ground_, least_radius_;
  double least_mass_ = 0;
  Slot x_, y_, z_, shape_, volume_, multiplicity_, water_, dry_, place_, fallen_, fallen_drops_;
  Budget water_ledger_, aerosol_ledger_;
  FallSpeedTable table_;
};

}  // namespace pileus::superdroplets

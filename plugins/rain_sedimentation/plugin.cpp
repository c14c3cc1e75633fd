// The operator that lets rain fall from parcel to parcel and onto the ground.
#include <pileus/plugin.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "fall_speed.hpp"
#include "sedimentation.hpp"

namespace pileus::sedimentation {
namespace {

class RainSedimentation : public Operator<RainSedimentation> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    scheme_ = d.choice("fall_speed", {"seifert_beheng", "khairoutdinov_kogan"})
                  .doc("of rain, by the mean size of the drops in a cell");
    density_ = d.number("air_density", "kg m-3", 1.2)
                   .range(1e-3, 10.0)
                   .doc("of the air: turns mass per mass into rain on the ground");
    ground_ = d.number("ground", "m", -1e6)
                  .range(-1e6, 1e6)
                  .doc(
                      "height of the ground, taken to the nearest face of the mesh's cells; below "
                      "it no rain falls. The bottom of the domain where that is higher");
    x_ = d.reads("x_position", "m");
    y_ = d.reads("y_position", "m").doc("does not exist in two dimensions");
    height_ = d.reads("height", "m");
    volume_ = d.reads("parcel_volume", "m3");
    rain_ = d.updates("mass_fraction_of_rain_in_air", "1").intensive("water").range(0.0, 1.0);
    drops_ = d.updates("number_of_raindrops_per_mass_of_air", "kg-1").intensive().range(0.0, 1e16);
    fallen_ = d.accumulates("rainfall_amount", "kg m-2").range(0.0, 1e6);
    fallen_drops_ = d.accumulates("raindrop_number_at_surface", "m-2").range(0.0, 1e25);
    water_ = d.budget("water");
  }

  void apply(const pileus_step& step, Block block) const {
    const double* rain = block.in(rain_);
    if (std::none_of(rain, rain + block.count(), [](double q) { return q > 0; })) return;
    if (block.raw().grid == nullptr) throw Failure("rain cannot fall without a mesh");
    const Cells cells(*block.raw().grid);
    Field field(block, cells);
    gather(block, field);
    block.book(water_, -let_fall(block, field, step.dt));
    block.repaired(scatter(block, field));
    for (const Slot slot : {rain_, drops_})
      expect_in_range(block, slot,
                      "rain piles up to more than air can hold: what falls in is more than what "
                      "falls out; take shorter steps, or the rain was too much before");
  }

 private:
  /// The cell of a position.
  struct Cells {
    explicit Cells(const pileus_grid& grid) : grid_(grid) {}
    std::int64_t columns() const { return grid_.cells[0] * grid_.cells[1]; }
    std::int64_t levels() const { return grid_.cells[2]; }
    std::int64_t count() const { return columns() * levels(); }
    double depth() const { return grid_.spacing[2]; }
    /// Number of levels below a height.
    std::int64_t below(double height) const {
      const double faces = std::round((height - grid_.origin[2]) / grid_.spacing[2]);
      return static_cast<std::int64_t>(std::clamp(faces, 0.0, static_cast<double>(levels())));
    }
    /// Of a column's ground, m2; of one metre in y in two dimensions.
    double area() const { return grid_.spacing[0] * (grid_.dimension == 3 ? grid_.spacing[1] : 1); }
    /// Column-wise, bottom first: a column's cells lie together.
    std::int64_t of(double x, double y, double z) const {
      const std::int64_t column = along(0, x) + grid_.cells[0] * along(1, y);
      return column * levels() + along(2, z);
    }

   private:
    std::int64_t along(int axis, double x) const {
      if (grid_.cells[axis] == 1) return 0;
      const double place = std::floor((x - grid_.origin[axis]) / grid_.spacing[axis]);
      const auto last = static_cast<double>(grid_.cells[axis] - 1);
      // A place that is not a number is in the first cell: it must not lead outside the mesh.
      return static_cast<std::int64_t>(place > 0 ? std::min(place, last) : 0.0);
    }
    const pileus_grid& grid_;
  };

  /// Sums over the parcels of every cell, and what the fall makes of them.
  struct Field {
    Field(const Block& block, const Cells& mesh)
        : cells(mesh), size(static_cast<std::size_t>(mesh.count())) {
      const std::span<double> room = block.scratch(5 * size + columnar * levels());
      std::size_t at = 0;
      for (std::span<double>* s : {&volume, &mass, &number, &mass_kept, &number_kept}) {
        *s = room.subspan(at, size);
        at += size;
      }
      work = room.subspan(at, columnar * levels());
      for (double& v : room.first(3 * size)) v = 0;
    }
    std::size_t levels() const { return static_cast<std::size_t>(cells.levels()); }

    static constexpr std::size_t columnar = 3;
    const Cells& cells;
    std::size_t size;
    std::span<double> volume, mass, number;    // Σ V, Σ V q_r, Σ V n_r; later what arrived
    std::span<double> mass_kept, number_kept;  // share that stays where it is
    std::span<double> work;
  };

  /// Where the parcels are.
  struct Places {
    const double *x, *y, *z;  // y is null in two dimensions
    std::size_t cell(const Cells& cells, std::int64_t p) const {
      return static_cast<std::size_t>(cells.of(x[p], y != nullptr ? y[p] : 0.0, z[p]));
    }
  };
  Places places(const Block& block) const {
    return {block.in(x_), block.has(y_) ? block.in(y_) : nullptr, block.in(height_)};
  }

  /// In the order of the parcels, so that the sums do not depend on the number of threads.
  void gather(const Block& block, Field& f) const {
    const double* volume = block.in(volume_);
    const double* rain = block.in(rain_);
    const double* drops = block.in(drops_);
    const Places at = places(block);
    for (std::int64_t p = 0; p < block.count(); ++p) {
      const std::size_t k = at.cell(f.cells, p);
      f.volume[k] += volume[p];
      f.mass[k] += volume[p] * rain[p];
      f.number[k] += volume[p] * drops[p];
    }
  }

  /// Adds what reaches the ground to its quantities and returns its Σ V q_r.
  double let_fall(const Block& block, Field& f, double dt) const {
    double* fallen = block.accumulator(fallen_);
    double* fallen_drops = block.accumulator(fallen_drops_);
    const double per_area = value(density_) / f.cells.area();
    const auto scheme = static_cast<FallSpeedScheme>(choice(scheme_));
    const std::size_t all = f.levels(),
                      buried = static_cast<std::size_t>(f.cells.below(value(ground_)));
    const std::size_t levels = all - buried;
    const std::span<double> fast = f.work.first(levels), slow = f.work.subspan(levels, levels);
    const std::span<double> room = f.work.subspan(2 * levels, levels);
    double ground = 0;
    for (std::size_t column = 0; column < f.size; column += all) {
      const std::size_t lowest = column + buried;
      for (std::size_t k = 0; k < levels; ++k) {
        const double mass = f.mass[lowest + k], number = f.number[lowest + k];
        FallSpeeds v;
        if (mass > 0)
          v = fall_speeds(scheme, mass / std::max(number, mass / drops::largest_raindrop),
                          value(density_));
        fast[k] = v.mass * dt / f.cells.depth();
        slow[k] = v.number * dt / f.cells.depth();
      }
      FallingAmount mass{f.mass.subspan(lowest, levels), f.mass_kept.subspan(lowest, levels)};
      FallingAmount number{f.number.subspan(lowest, levels), f.number_kept.subspan(lowest, levels)};
      mass.ground = bury(f.mass.subspan(column, buried), f.mass_kept.subspan(column, buried));
      number.ground = bury(f.number.subspan(column, buried), f.number_kept.subspan(column, buried));
      fall(mass, fast, f.volume.subspan(lowest, levels), room);
      fall(number, slow, f.volume.subspan(lowest, levels), room);
      fallen[column / all] += per_area * mass.ground;
      fallen_drops[column / all] += per_area * number.ground;
      ground += mass.ground;
    }
    return ground;
  }

  /// What cells below the ground held, all of it, lies on the ground. Returns its sum.
  static double bury(std::span<double> held, std::span<double> kept) {
    double sum = 0;
    for (std::size_t k = 0; k < held.size(); ++k) {
      sum += held[k];
      held[k] = 0;
      kept[k] = 0;
    }
    return sum;
  }

  /// Gives every parcel what it keeps and its share by volume of what arrived in its cell. Returns
  /// how many numbers were moved to belong to drops that exist.
  std::uint64_t scatter(const Block& block, const Field& f) const {
    double* rain = block.out(rain_);
    double* drops = block.out(drops_);
    const Places at = places(block);
    std::uint64_t repairs = 0;
    for (std::int64_t p = 0; p < block.count(); ++p) {
      const std::size_t k = at.cell(f.cells, p);
      if (f.mass[k] == 0 && f.mass_kept[k] == 1 && f.number[k] == 0) continue;
      rain[p] = rain[p] * f.mass_kept[k] + f.mass[k] / f.volume[k];
      const double number = drops[p] * f.number_kept[k] + f.number[k] / f.volume[k];
      drops[p] = rain[p] > 0 ? std::max(number, rain[p] / drops::largest_raindrop) : 0.0;
      repairs += drops[p] != number;
    }
    return repairs;
  }

  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.rain_sedimentation";
    d.op.kind = "microphysics";
    d.op.version = "1.0.0";
    d.op.title = "Sedimentation of rain between parcels";
    d.op.summary =
        "Hands rain from the parcels of each cell to those of the cells below it, and to the "
        "ground, at the fall speed of the cell's mean drops.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.provides("sedimentation");
    d.cites("10.1007/s00703-005-0112-4", "Seifert & Beheng 2006: fall speeds");
    d.cites("10.1175/1520-0493(2000)128<0229:ANCPPI>2.0.CO;2",
            "Khairoutdinov & Kogan 2000: fall speeds, eq. 37");
  }

  Slot x_, y_, height_, volume_, rain_, drops_, fallen_, fallen_drops_;
  Param scheme_, density_, ground_;
  Budget water_;
};

}  // namespace
}  // namespace pileus::sedimentation

PILEUS_PLUGIN(pileus::sedimentation::RainSedimentation, "org.pileus.rain_sedimentation", "1.0.0");

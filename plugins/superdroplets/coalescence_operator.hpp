// The operator that lets droplets collide with others of the same air.
#pragma once
#include <pileus/plugin.hpp>

#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "cell_lists.hpp"
#include "coalescence.hpp"
#include "collision_kernels.hpp"
#include "droplet_quantities.hpp"

namespace pileus::superdroplets {

class CoalescenceOperator : public Operator<CoalescenceOperator> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    kernel_ =
        d.choice("kernel", {"hall", "long", "geometric", "golovin", "constant", "long_polynomial"})
            .doc("rate at which two drops meet and merge");
    golovin_ = d.number("golovin_coefficient", "s-1", 1500.0)
                   .range(0.0, 1e9)
                   .when("kernel == golovin")
                   .doc("b of K = b (X + x), X and x volumes");
    constant_ = d.number("constant_rate", "m3 s-1", 1e-10)
                    .range(0.0, 1.0)
                    .when("kernel == constant")
                    .doc("K");
    efficiency_ = d.number("collection_efficiency", "1", 1.0)
                      .range(0.0, 10.0)
                      .when("kernel == geometric")
                      .doc("share of the drops in the swept volume that merge");
    describe_fall_speed(d, fall_speed_, temperature_, pressure_);
    shared_ = d.choice("shared_air", {"cell", "parcel"})
                  .doc("droplets collide with all of their cell of the mesh, or of their parcel");
    static constexpr double ladder[] = {
        0.1, 0.03, 0.01, 0.005, 0.002, 0.001, std::numeric_limits<double>::quiet_NaN()};
    change_ = d.number("largest_change", "1", 0.005)
                  .range(1e-6, 1e6)
                  .knob(ladder)
                  .doc("of number and of half the second moment of mass within a sub-step");
    substeps_ = d.integer("most_collision_substeps", 64)
                    .range(1, 1024)
                    .doc("of a step in each volume of air");
    x_ = d.reads("x_position", "m");
    y_ = d.reads("y_position", "m").doc("does not exist in two dimensions");
    z_ = d.reads("height", "m");
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
    hygroscopic_ = d.updates_of_items(hygroscopic_volume_name, "m3")
                       .of_each(multiplicity_name)
                       .range(0.0, largest_particle)
                       .optional();
    d.budget(water_budget);
    d.budget(aerosol_budget);
  }

  void configured() {
    table_ = FallSpeedTable(static_cast<FallSpeedScheme>(choice(fall_speed_)), value(temperature_),
                            value(pressure_));
    options_.largest_change = value(change_);
    options_.most_substeps = static_cast<int>(integer(substeps_));
  }

  void apply(const pileus_step& step, Block block) const {
    switch (choice(kernel_)) {
      case 0:
        return collide(TabulatedKernel{HallKernel{}, table_}, step, block);
      case 1:
        return collide(TabulatedKernel{LongKernel{}, table_}, step, block);
      case 2:
        return collide(TabulatedKernel{GeometricKernel{value(efficiency_)}, table_}, step, block);
      case 3:
        return collide(GolovinKernel{value(golovin_)}, step, block);
      case 4:
        return collide(ConstantKernel{value(constant_)}, step, block);
      default:
        return collide(LongPolynomialKernel{}, step, block);
    }
  }

  static void describe_fall_speed(Declaration& d, Param& scheme, Param& temperature,
                                  Param& pressure) {
    scheme = d.choice("fall_speed", {"beard_1976", "beard_1977", "gunn_kinzer", "rogers_yau",
                                     "simmel", "rogers_1993", "none"})
                 .doc("of drops by their mass");
    temperature = d.number("fall_speed_temperature", "K", 293.15)
                      .range(150.0, 350.0)
                      .doc("of the air that fall speeds are computed for");
    pressure = d.number("fall_speed_pressure", "Pa", 101325.0).range(1e3, 2e5).doc("of that air");
  }

 private:
  /// One volume of air after the other, each with random numbers of its own.
  template <class Kernel>
  void collide(const Kernel& kernel, const pileus_step& step, const Block& block) const {
    const DropColumns columns{block.whole_out(multiplicity_), block.out(water_),
                              block.has(dry_) ? block.out(dry_) : nullptr,
                              block.has(hygroscopic_) ? block.out(hygroscopic_) : nullptr};
    const bool by_cell = choice(shared_) == 0 && block.raw().grid != nullptr;
    const double* volume = block.in(volume_);
    CellLists cells;
    if (by_cell) {
      cells = CellLists(*block.raw().grid, static_cast<std::size_t>(block.count()), block.in(x_),
                        block.has(y_) ? block.in(y_) : nullptr, block.in(z_));
    } else {
      cells = CellLists::each_alone(static_cast<std::size_t>(block.count()));
    }
    constexpr std::int64_t grain = 64;
    parallel_chunks(
        static_cast<std::int64_t>(cells.cells()), grain, [&](std::int64_t begin, std::int64_t end) {
          CoalescenceScratch scratch;
          std::vector<std::uint32_t> items;
          double deficit = 0;
          for (std::int64_t c = begin; c < end; ++c) {
            items.clear();
            double air = 0;
            for (const std::uint32_t p : cells.parcels(static_cast<std::size_t>(c))) {
              air += volume[p];
              for (std::int64_t i = block.item_begin(p); i < block.item_end(p); ++i)
                if (columns.multiplicity[i] > 0) items.push_back(static_cast<std::uint32_t>(i));
            }
            const std::uint64_t whose = by_cell ? static_cast<std::uint64_t>(c) : block.uid(c);
            const DrawKey key{step.seed, step.stream, whose, step.number, step.call, 0};
            deficit += coalesce(kernel, columns, std::span<const std::uint32_t>(items), air,
                                step.dt, key, options_, scratch)
                           .deficit;
          }
          if (deficit > 0) block.repaired(1);
        });
  }

  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.superdroplets.coalescence";
    d.op.kind = "microphysics";
    d.op.version = "1.0.0";
    d.op.title = "Collision and coalescence of superdroplets";
    d.op.summary =
        "Pairs the superdroplets that share air at random and lets them merge as often as the "
        "kernel has it.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.op.flags = PILEUS_RANDOM;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("coalescence");
    d.requires_effect("size_resolved_droplets");
    d.cites("10.1002/qj.441", "Shima et al. 2009: pairing in linear time");
    d.cites("10.1175/1520-0469(1980)037<2486:ADMMTE>2.0.CO;2", "Hall 1980: collision efficiency");
    d.cites("10.1175/1520-0469(1974)031<1040:STTDCE>2.0.CO;2", "Long 1974: kernels");
    d.cites("10.1175/1520-0469(1976)033<0851:TVASOC>2.0.CO;2", "Beard 1976: fall speeds");
  }

  Param kernel_, golovin_, constant_, efficiency_, fall_speed_, temperature_, pressure_, shared_;
  Param change_, substeps_;
  Slot x_, y_, z_, volume_, multiplicity_, water_, dry_, hygroscopic_;
  FallSpeedTable table_;
  CoalescenceOptions options_;
};

}  // namespace pileus::superdroplets

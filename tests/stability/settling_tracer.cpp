// Parcels near the ground lose their tracer to it at a fixed rate: the smallest operator that fills
// a quantity of the ground.
#include <pileus/numerics.hpp>
#include <pileus/plugin.hpp>

#include <algorithm>
#include <cmath>

class SettlingTracer : public pileus::Operator<SettlingTracer> {
  pileus::Slot tracer_, volume_, x_, y_, height_, ground_;
  pileus::Param depth_, time_scale_, plane_;
  pileus::Budget tracer_budget_;

 public:
  void describe(pileus::Declaration& d) {
    d.op.id = "org.pileus.test_settling";
    d.op.kind = "test";
    d.op.version = "1.0.0";
    d.op.title = "Settling tracer";
    d.op.summary = "Moves tracer from parcels near the ground to the ground.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    plane_ = d.toggle("plane", false).doc("the run is two-dimensional");
    tracer_ = d.owns("passive_tracer", "1").intensive("tracer").range(0, 1e6);
    volume_ = d.reads("parcel_volume", "m3");
    x_ = d.reads("x_position", "m");
    y_ = d.reads("y_position", "m").when("plane == false");
    height_ = d.reads("height", "m");
    ground_ = d.accumulates("rainfall_amount", "kg m-2").range(0, 1e9);
    depth_ = d.number("depth", "m", 100).doc("height below which parcels lose tracer");
    time_scale_ = d.number("time_scale", "s", 100).range(1e-3, 1e30).doc("e-folding time");
    tracer_budget_ = d.budget("tracer");
  }

  void apply(const pileus_step& step, pileus::Block block) const {
    const pileus_grid& grid = *block.raw().grid;
    double* q = block.out(tracer_);
    double* ground = block.accumulator(ground_);
    const double share = -std::expm1(-step.dt / value(time_scale_));
    const double area = grid.spacing[0] * (grid.dimension == 3 ? grid.spacing[1] : 1.0);
    block.each([&](auto p) {
      if (block.in(height_)[p] > value(depth_)) return;
      const double loss = share * q[p];
      const std::int64_t row = block.has(y_) ? cell(block.in(y_)[p], grid, 1) : 0;
      q[p] -= loss;
      ground[cell(block.in(x_)[p], grid, 0) + grid.cells[0] * row] +=
          loss * block.in(volume_)[p] / area;
      block.book(tracer_budget_, -loss * block.in(volume_)[p]);
    });
  }

 private:
  static std::int64_t cell(double position, const pileus_grid& grid, int axis) {
    const double at = std::floor((position - grid.origin[axis]) / grid.spacing[axis]);
    return std::min(static_cast<std::int64_t>(at), grid.cells[axis] - 1);
  }
};
PILEUS_PLUGIN(SettlingTracer, "org.pileus.test_settling", "1.0.0");

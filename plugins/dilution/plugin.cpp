// Parcels that grow into their surroundings, and so split and merge: mixing by dilution.
#include <pileus/plugin.hpp>

#include <array>
#include <limits>

#include "growth.hpp"

namespace pileus::dilution {
namespace {

class Dilution : public Operator<Dilution> {
 public:
  void describe(Declaration& d) {
    d.op.id = "org.pileus.dilution";
    d.op.kind = "mixing";
    d.op.version = "1.0.0";
    d.op.title = "Growth and dilution of parcels";
    d.op.summary =
        "Lets parcels grow at the rate of the strain beyond the volume they hold, so that they "
        "split and merge sooner; mergers keep the second moment.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("subgrid_entrainment");
    d.cites("10.1098/rspa.1926.0043", "Richardson 1926: the four-thirds law");
    d.cites("10.1016/j.jcpx.2023.100136", "Frey et al. 2023: EPIC, whose mergers this changes");
    static constexpr double rates[] = {0.0, 0.5, 1.0,
                                       2.0, 4.0, std::numeric_limits<double>::quiet_NaN()};
    rate_ = d.number("rate", "1", 2.0)
                .range(0.0, 100.0)
                .knob(rates)
                .doc("c: rate of growth of a parcel of the cell's volume over the strain rate |S|");
    constexpr std::array<const char*, 6> names = {"shape_xx", "shape_xy", "shape_xz",
                                                  "shape_yy", "shape_yz", "shape_zz"};
    for (std::size_t c = 0; c < names.size(); ++c)
      shape_[c] = d.updates(names[c], "m2").optional().doc("component of the shape matrix");
    volume_ = d.reads("parcel_volume", "m3").doc("what the parcel holds: its size at the start");
    size_ = d.owns("parcel_size_volume", "m3")
                .extensive()
                .range(0.0, 1e300)
                .doc("volume of the ellipsoid that the shape describes");
    strain_ = d.reads_mesh_at_parcel("strain_rate_magnitude", "s-1").doc("of the gridded flow");
  }

  void init(const pileus_step&, Block whole) const {
    const double* volume = whole.in(volume_);
    double* size = whole.out(size_);
    for (std::int64_t p = 0; p < whole.count(); ++p) size[p] = volume[p];
  }

  void apply(const pileus_step& step, Block block) const {
    const pileus_grid* grid = block.raw().grid;
    if (grid == nullptr) throw Failure("it needs a mesh, which this run does not have");
    const double area = grid->spacing[0] * grid->spacing[2];
    if (grid->dimension == 3)
      grow<3>(step, block, area * grid->spacing[1]);
    else
      grow<2>(step, block, area);
  }

 private:
  template <int D>
  void grow(const pileus_step& step, Block block, double cell) const {
    constexpr std::array<std::size_t, 3> plane = {0, 2, 5};
    constexpr std::size_t components = D == 3 ? 6 : 3;
    std::array<double*, components> shape;
    for (std::size_t c = 0; c < components; ++c)
      shape[c] = block.out(shape_[D == 3 ? c : plane[c % 3]]);
    double* size = block.out(size_);
    const double* strain = block.in(strain_);
    block.each([&](auto p) {
      const double grown = grown_volume<D>(size[p], cell, value(rate_), strain[p], step.dt);
      if (grown == size[p]) return;
      const double factor = shape_factor<D>(grown / size[p]);
      for (double* b : shape) b[p] *= factor;
      size[p] = grown;
    });
  }

  std::array<Slot, 6> shape_;
  Slot volume_, size_, strain_;
  Param rate_;
};

}  // namespace
}  // namespace pileus::dilution

PILEUS_PLUGIN(pileus::dilution::Dilution, "org.pileus.dilution", "1.0.0");

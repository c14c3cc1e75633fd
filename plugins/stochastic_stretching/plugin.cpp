// Unresolved stretching of the parcels' shapes, so that they split and merge as a turbulent flow
// would make them.
#include <pileus/normal.hpp>
#include <pileus/plugin.hpp>

#include <algorithm>
#include <limits>

#include "stretching.hpp"

namespace pileus::stretching {
namespace {

class StochasticStretching : public Operator<StochasticStretching> {
 public:
  void describe(Declaration& d) {
    d.op.id = "org.pileus.stochastic_stretching";
    d.op.kind = "mixing";
    d.op.version = "1.0.0";
    d.op.title = "Stochastic stretching of parcels";
    d.op.summary =
        "Deforms the parcels' shapes by an isotropic, volume-preserving random strain, so that "
        "unresolved stretching makes them split and merge.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.flags = PILEUS_RANDOM;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("subgrid_stretching");
    d.cites("10.1017/S002211205900009X", "Batchelor 1959: small scales strained at random");
    d.cites("10.1017/S0022112074001881", "Kraichnan 1974: a gradient that is white in time");
    describe_parameters(d);
    shape_[0] = shape(d, "shape_xx", false);
    shape_[1] = shape(d, "shape_xy", true);
    shape_[2] = shape(d, "shape_xz", false);
    shape_[3] = shape(d, "shape_yy", true);
    shape_[4] = shape(d, "shape_yz", true);
    shape_[5] = shape(d, "shape_zz", false);
    strain_ = d.reads_mesh_at_parcel("strain_rate_magnitude", "s-1")
                  .when("intensity == strain")
                  .doc("of the gridded flow");
  }

  /// The expected increment of ln B in one step stays below `largest_increment`.
  double prepare(const pileus_step&, Block whole) {
    const double d = dimension(whole);
    double rate = value(rate_);
    if (choice(intensity_) == 0) {
      double strain = 0;
      const double* s = whole.in(strain_);
      for (std::int64_t p = 0; p < whole.count(); ++p) strain = std::max(strain, s[p]);
      rate = value(coefficient_) * strain / (d * (d + 2) * (d - 1));
    }
    const double largest = value(increment_);
    return rate > 0 ? largest * largest / (rate * d * (d + 2) * (d - 1))
                    : std::numeric_limits<double>::infinity();
  }

  void apply(const pileus_step& step, Block block) const {
    if (dimension(block) == 3)
      stretch<3>(step, block);
    else
      stretch<2>(step, block);
  }

 private:
  void describe_parameters(Declaration& d) {
    static constexpr double coefficients[] = {0.0, 0.3, 1.0, 3.0,
                                              std::numeric_limits<double>::quiet_NaN()};
    static constexpr double increments[] = {1.0, 0.5, 0.25,
                                            std::numeric_limits<double>::quiet_NaN()};
    intensity_ =
        d.choice("intensity", {"strain", "constant"}).doc("from the strain of the flow, or given");
    coefficient_ = d.number("coefficient", "1", 1.0)
                       .range(0.0, 100.0)
                       .knob(coefficients)
                       .when("intensity == strain")
                       .doc("mean square of the unresolved velocity gradient over |S|²");
    rate_ = d.number("rate", "s-1", 0.0)
                .range(0.0, 1e3)
                .when("intensity == constant")
                .doc("intensity D of the random gradient");
    increment_ = d.number("largest_increment", "1", 0.5)
                     .range(0.01, 2.0)
                     .knob(increments)
                     .doc("typical deformation of one sub-step");
  }
  static Slot shape(Declaration& d, const char* name, bool in_space_only) {
    auto row = d.updates(name, "m2").doc("component of the shape matrix");
    if (in_space_only) row.optional();
    return row;
  }
  /// Three where parcels have a y direction.
  int dimension(Block block) const { return block.has(shape_[3]) ? 3 : 2; }

  template <int D>
  void stretch(const pileus_step& step, Block block) const {
    // Row-by-row position of the stored upper triangle in the full matrix.
    constexpr int components = D == 3 ? 6 : 3;
    constexpr int stored[6] = {0, 1, 2, 3, 4, 5}, in_plane[3] = {0, 2, 5};
    double* column[components];
    for (int c = 0; c < components; ++c)
      column[c] = block.out(shape_[static_cast<std::size_t>(D == 3 ? stored[c] : in_plane[c])]);
    const bool from_strain = choice(intensity_) == 0;
    const double* strain = from_strain ? block.in(strain_) : nullptr;
    block.each([&](auto p) {
      const double d =
          from_strain ? intensity_of_strain<D>(value(coefficient_), strain[p]) : value(rate_);
      if (!(d > 0)) return;
      double normal[D * D];
      draw_normal(step, block.uid(p), 0, D * D, normal);
      Matrix<D> b;
      for (int i = 0, c = 0; i < D; ++i)
        for (int j = i; j < D; ++j, ++c) b[i * D + j] = b[j * D + i] = column[c][p];
      b = stretched<D>(b, d, step.dt, normal);
      for (int i = 0, c = 0; i < D; ++i)
        for (int j = i; j < D; ++j, ++c) column[c][p] = b[i * D + j];
    });
  }

  std::array<Slot, 6> shape_;
  Slot strain_;
  Param intensity_, coefficient_, rate_, increment_;
};

}  // namespace
}  // namespace pileus::stretching

PILEUS_PLUGIN(pileus::stretching::StochasticStretching, "org.pileus.stochastic_stretching",
              "1.0.0");

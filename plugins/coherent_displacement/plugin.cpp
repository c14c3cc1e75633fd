// Sub-grid motion of parcels by one random flow for all of them, which has no divergence.
#include <pileus/normal.hpp>
#include <pileus/plugin.hpp>

#include <algorithm>
#include <array>
#include <limits>

#include "random_flow.hpp"

namespace pileus::coherent {
namespace {

class CoherentDisplacement : public Operator<CoherentDisplacement> {
 public:
  void describe(Declaration& d) {
    d.op.id = "org.pileus.coherent_displacement";
    d.op.kind = "mixing";
    d.op.version = "1.0.0";
    d.op.title = "Coherent sub-grid motion of parcels";
    d.op.summary =
        "Moves and deforms parcels by a random flow without divergence that neighbours share.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.op.flags = PILEUS_RANDOM;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("subgrid_displacement");
    d.provides("subgrid_stretching", "deform_shapes == true");
    d.cites("10.1017/S0022112074001881", "Kraichnan 1974: a flow that is white in time");
    describe_parameters(d);
    position_[0] = d.updates("x_position", "m").doc("of the parcel's centre");
    position_[1] = d.updates("y_position", "m").optional().doc("in three dimensions");
    position_[2] = d.updates("z_position", "m").doc("of the parcel's centre");
    constexpr std::array<const char*, 6> names = {"shape_xx", "shape_xy", "shape_xz",
                                                  "shape_yy", "shape_yz", "shape_zz"};
    for (std::size_t c = 0; c < names.size(); ++c)
      shape_[c] = d.updates(names[c], "m2")
                      .optional()
                      .when("deform_shapes == true")
                      .doc("component of the shape matrix");
    strain_ = d.reads_mesh("strain_rate_magnitude", "s-1")
                  .when("intensity == strain")
                  .doc("of the gridded flow");
  }

  /// A typical displacement of a sub-step stays below `courant` cells.
  double prepare(const pileus_step&, Block whole) {
    const pileus_grid& grid = mesh_of(whole);
    double rate = 0;
    if (choice(from_) == 0) {
      const pileus_view& view = whole.raw().views[strain_.index];
      const Strided<const double> strain(view);
      for (std::int64_t node = 0; node < view.count; ++node)
        rate = std::max(rate, strain(node) * value(smagorinsky_) * value(smagorinsky_));
    } else {
      rate = relative_diffusivity(grid);
    }
    return rate > 0 ? value(courant_) * value(courant_) / (2 * rate)
                    : std::numeric_limits<double>::infinity();
  }

  void apply(const pileus_step& step, Block block) const {
    if (mesh_of(block).dimension == 3)
      displace<3>(step, block);
    else
      displace<2>(step, block);
  }

 private:
  void describe_parameters(Declaration& d) {
    static constexpr double courants[] = {1.0, 0.5, 0.25, std::numeric_limits<double>::quiet_NaN()};
    from_ =
        d.choice("intensity", {"strain", "constant"}).doc("from the strain of the flow, or given");
    smagorinsky_ = d.number("smagorinsky", "1", 0.2)
                       .range(0.0, 10.0)
                       .when("intensity == strain")
                       .doc("C_s in K = (C_s Δ)² |S|, Δ the mean mesh width");
    diffusivity_ = d.number("diffusivity", "m2 s-1", 0.0)
                       .range(0.0, 1e9)
                       .when("intensity == constant")
                       .doc("K, the same everywhere");
    deform_ = d.toggle("deform_shapes", true).doc("whether the flow deforms the parcels, too");
    courant_ = d.number("courant", "1", 0.5)
                   .range(0.01, 2.0)
                   .knob(courants)
                   .doc("largest typical displacement of a sub-step in mesh widths");
  }

  static const pileus_grid& mesh_of(Block block) {
    const pileus_grid* grid = block.raw().grid;
    if (grid == nullptr) throw Failure("it needs a mesh, which this run does not have");
    return *grid;
  }
  /// K/Δ² where K is given.
  double relative_diffusivity(const pileus_grid& grid) const {
    const double area = grid.spacing[0] * grid.spacing[2];
    const double squared = grid.dimension == 3 ? std::pow(area * grid.spacing[1], 2.0 / 3.0) : area;
    return value(diffusivity_) / squared;
  }

  /// One realisation: normal draws on the nodes, keyed by the node, times an amplitude for which
  /// ⟨ξ_i²⟩ = 2 K dt (Δ_i/Δ)². Zero on the walls in the components along them, odd or even beyond.
  template <int D>
  const double* draw_potential(const pileus_step& step, Block block) const {
    constexpr int components = RandomFlow<D>::components;
    const pileus_grid& grid = *block.raw().grid;
    const std::int64_t levels = grid.cells[2] + 3, top = grid.cells[2];
    const std::int64_t columns = grid.cells[0] * (D == 3 ? grid.cells[1] : 1);
    double* potential =
        block.scratch(static_cast<std::size_t>(columns * levels * components)).data();
    const double hx = grid.spacing[0], hy = grid.spacing[1], hz = grid.spacing[2];
    const double area[3] = {D == 3 ? hy * hz : hx * hz, hx * hz, hx * hy};
    const bool from_strain = choice(from_) == 0;
    const pileus_view nothing{};
    const Strided<const double> strain(from_strain ? block.raw().views[strain_.index] : nothing);
    const double squared = value(smagorinsky_) * value(smagorinsky_),
                 given = from_strain ? 0.0 : relative_diffusivity(grid);
    parallel_for(columns, [&](std::int64_t column) {
      double* of_column = potential + column * levels * components;
      for (std::int64_t k = 0; k <= top; ++k) {
        const std::int64_t node = column * levels + k + 1;
        const double rate = from_strain ? squared * strain(node) : given;
        const double amplitude = std::sqrt(2 * rate * step.dt / mean_square<D>);
        double normal[components];
        draw_normal(step, static_cast<std::uint64_t>(node), 0, components, normal);
        for (int c = 0; c < components; ++c) {
          const bool along_wall = D == 2 || c < 2;
          const bool on_wall = k == 0 || k == top;
          of_column[(k + 1) * components + c] =
              along_wall && on_wall ? 0.0 : amplitude * area[c] * normal[c];
        }
      }
      for (int c = 0; c < components; ++c) {
        const double sign = D == 2 || c < 2 ? -1.0 : 1.0;
        const std::int64_t inside = std::min<std::int64_t>(1, top);
        of_column[c] = sign * of_column[(inside + 1) * components + c];
        of_column[(top + 2) * components + c] =
            sign * of_column[(top - inside + 1) * components + c];
      }
    });
    return potential;
  }

  template <int D>
  void displace(const pileus_step& step, Block block) const {
    constexpr std::array<std::size_t, 6> stored = {0, 1, 2, 3, 4, 5};
    constexpr std::array<std::size_t, 3> plane = {0, 2, 5};
    constexpr std::size_t shapes = D == 3 ? 6 : 3;
    const pileus_grid& grid = *block.raw().grid;
    const RandomFlow<D> flow(grid, draw_potential<D>(step, block));
    const double bottom = grid.origin[2],
                 top = bottom + static_cast<double>(grid.cells[2]) * grid.spacing[2];
    const bool deform = is_on(deform_);
    double* position[D];
    std::array<double*, shapes> shape{};
    for (int d = 0; d < D; ++d)
      position[d] = block.out(position_[d == D - 1 ? 2 : static_cast<std::size_t>(d)]);
    for (std::size_t c = 0; deform && c < shapes; ++c)
      shape[c] = block.out(shape_[D == 3 ? stored[c] : plane[c % 3]]);
    parallel_for(block.count(), [&](std::int64_t p) {
      double x[D], middle[D];
      for (int d = 0; d < D; ++d) x[d] = position[d][p];
      const int pieces = pieces_for<D>(flow.gradient(x));
      for (int piece = 0; piece < pieces; ++piece) {
        follow<D>(flow, 1.0 / pieces, x, middle);
        x[D - 1] = inside(x[D - 1], bottom, top);
        if (!deform) continue;
        Matrix<D> stretch = flow.gradient(middle);
        for (double& v : stretch) v /= pieces;
        deform_shape<D>(exponential<D>(stretch), shape.data(), p);
      }
      for (int d = 0; d < D; ++d) position[d][p] = x[d];
    });
  }

  /// B ← E B Eᵀ. The exponential of a traceless matrix has determinant one, and the core restores
  /// what rounding has changed.
  template <int D>
  static void deform_shape(const Matrix<D>& e, double* const* shape, std::int64_t p) {
    Matrix<D> b;
    for (int i = 0, c = 0; i < D; ++i)
      for (int j = i; j < D; ++j, ++c) b[i * D + j] = b[j * D + i] = shape[c][p];
    b = product<D>(product<D>(e, b), transposed<D>(e));
    for (int i = 0, c = 0; i < D; ++i)
      for (int j = i; j < D; ++j, ++c) shape[c][p] = 0.5 * (b[i * D + j] + b[j * D + i]);
  }

  std::array<Slot, 3> position_;
  std::array<Slot, 6> shape_;
  Slot strain_;
  Param from_, smagorinsky_, diffusivity_, deform_, courant_;
};

}  // namespace
}  // namespace pileus::coherent

PILEUS_PLUGIN(pileus::coherent::CoherentDisplacement, "org.pileus.coherent_displacement", "1.0.0");

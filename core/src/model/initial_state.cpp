#include "model/initial_state.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "base/aligned_array.hpp"
#include "base/error.hpp"
#include "base/parallel.hpp"
#include "model/sixth_order_difference.hpp"
#include "parcels/lattice.hpp"
#include "scene/field_sampler.hpp"
#include "scene/problems.hpp"

namespace pileus::model {
namespace {

/// Positions of the parcels as the samplers want them.
template <int D>
struct Positions {
  std::array<const double*, D> axis;
  const double* x() const { return axis[0]; }
  const double* y() const { return D == 3 ? axis[1] : nullptr; }
  const double* z() const { return axis[D - 1]; }
};

template <int D>
Positions<D> positions_of(const parcels::Store& store) {
  Positions<D> p;
  for (int d = 0; d < D; ++d) p.axis[static_cast<std::size_t>(d)] = store.position(d);
  return p;
}

/// Central difference of the sixth order of one field along one axis at every parcel.
template <int D>
class Differentiator {
 public:
  Differentiator(const mesh::Grid<D>& grid, const parcels::Store& store)
      : grid_(grid), store_(store), shifted_(store.size()), value_(store.size()) {}

  void add(const scene::FieldSampler& field, int axis, double factor, double* sum) {
    const double h = grid_.spacing[static_cast<std::size_t>(axis)] * difference_step;
    for (int offset = 1; offset <= 3; ++offset)
      for (int side = -1; side <= 1; side += 2) {
        Positions<D> at = positions_of<D>(store_);
        const double* centre = at.axis[static_cast<std::size_t>(axis)];
        for (std::size_t p = 0; p < store_.size(); ++p) shifted_[p] = centre[p] + side * offset * h;
        at.axis[static_cast<std::size_t>(axis)] = shifted_.data();
        field.sample(store_.size(), at.x(), at.y(), at.z(), value_.data());
        const double w =
            factor * side * difference_weights[static_cast<std::size_t>(offset - 1)] / h;
        for (std::size_t p = 0; p < store_.size(); ++p) sum[p] += w * value_[p];
      }
  }

 private:
  const mesh::Grid<D>& grid_;
  const parcels::Store& store_;
  AlignedArray<double> shifted_, value_;
};

template <int D>
void set_vorticity_from_velocity(const scene::Scene& scene, const mesh::Grid<D>& grid,
                                 parcels::Store& store, dynamics::MeanWind& wind) {
  std::vector<scene::FieldSampler> velocity;
  for (const auto& field : scene.initial.velocity) velocity.emplace_back(field, scene);
  Differentiator<D> differentiate(grid, store);
  if constexpr (D == 3) {
    // ω = ∇ × u: component c takes ∂_a u_b − ∂_b u_a with (a, b, c) cyclic.
    for (int c = 0; c < 3; ++c) {
      const int a = (c + 1) % 3, b = (c + 2) % 3;
      differentiate.add(velocity[static_cast<std::size_t>(b)], a, 1.0, store.vorticity(c));
      differentiate.add(velocity[static_cast<std::size_t>(a)], b, -1.0, store.vorticity(c));
    }
  } else {
    // ζ = ∂w/∂x − ∂u/∂z
    differentiate.add(velocity[1], 0, 1.0, store.vorticity(0));
    differentiate.add(velocity[0], 1, -1.0, store.vorticity(0));
  }
  AlignedArray<double> u(store.size());
  const Positions<D> at = positions_of<D>(store);
  for (int d = 0; d < D - 1; ++d) {
    velocity[static_cast<std::size_t>(d)].sample(store.size(), at.x(), at.y(), at.z(), u.data());
    double sum = 0;
    for (std::size_t p = 0; p < store.size(); ++p) sum += store.volume()[p] * u[p];
    wind.velocity[static_cast<std::size_t>(d)] += sum / grid.domain_volume();
  }
}

}  // namespace

template <int D>
void thin_parcels(const scene::Scene& scene, parcels::Store& store) {
  const scene::FieldDescription& where = scene.parcels.where;
  const scene::FieldSampler sampler(where, scene);
  if (sampler.uniform_value()) return;
  std::vector<double> indicator(store.size());
  const Positions<D> at = positions_of<D>(store);
  sampler.sample(store.size(), at.x(), at.y(), at.z(), indicator.data());
  if (parcels::keep_positive(store, indicator) > 0) return;
  throw Error(
      ExitCode::usage,
      fmt::format("{}:{}:{}: error: 'parcels.where' is positive at none of the {} points of "
                  "the lattice, so there would be no parcel.",
                  where.where.file, where.where.line, where.where.column, store.size()));
}

template <int D>
void fill_initial_state(const scene::Scene& scene, const mesh::Grid<D>& grid, parcels::Store& store,
                        dynamics::MeanWind& wind) {
  const Positions<D> at = positions_of<D>(store);
  const auto sample = [&](const scene::FieldDescription& field, double* out) {
    scene::FieldSampler(field, scene).sample(store.size(), at.x(), at.y(), at.z(), out);
  };
  for (std::size_t d = 0; d < scene.initial.mean_wind.size() && d < 2; ++d)
    wind.velocity[d] = scene.initial.mean_wind[d];
  if (scene.initial.velocity_given)
    set_vorticity_from_velocity<D>(scene, grid, store, wind);
  else
    for (std::size_t c = 0; c < scene.initial.vorticity.size(); ++c)
      sample(scene.initial.vorticity[c], store.vorticity(static_cast<int>(c)));
  for (std::size_t s = 0; s < store.scalars().size(); ++s) {
    const parcels::Scalar& scalar = store.scalars()[s];
    if (scalar.nature == parcels::Nature::derived) continue;
    double* value = store.scalar(static_cast<int>(s));
    const auto given = scene.initial.scalars.find(scalar.name);
    if (given != scene.initial.scalars.end())
      sample(given->second, value);
    else
      for (std::size_t p = 0; p < store.size(); ++p) value[p] = scalar.initial;
  }
}

void give_initial_surface(const scene::Scene& scene, const pileus_grid& grid,
                          coupling::SurfaceFields& surface) {
  std::vector<double> x, y;
  for (std::int64_t j = 0; j < grid.cells[1]; ++j)
    for (std::int64_t i = 0; i < grid.cells[0]; ++i) {
      x.push_back(grid.origin[0] + (static_cast<double>(i) + 0.5) * grid.spacing[0]);
      y.push_back(grid.origin[1] + (static_cast<double>(j) + 0.5) * grid.spacing[1]);
    }
  const std::vector<double> z(x.size(), grid.origin[2]);
  for (std::size_t field = 0; field < surface.list().size(); ++field) {
    const auto given = scene.initial.scalars.find(surface.list()[field].name);
    if (given == scene.initial.scalars.end()) continue;
    std::vector<double> values(x.size());
    scene::FieldSampler(given->second, scene)
        .sample(x.size(), x.data(), y.data(), z.data(), values.data());
    surface.begin_with(field, std::move(values));
  }
}

dynamics::ReferenceProfile profile_over_height(const scene::FieldDescription& field,
                                               const scene::Scene& scene, const char* what,
                                               double bottom, double top, int points) {
  const scene::FieldSampler sampler(field, scene);
  if (!sampler.height_alone())
    throw Error(ExitCode::usage, fmt::format("{}: error: {} must be a function of z alone.",
                                             scene::describe(field.where), what));
  std::vector<double> z;
  for (int i = 0; i < points; ++i)
    z.push_back(bottom + static_cast<double>(i) / (points - 1) * (top - bottom));
  const std::vector<double> x(z.size(), scene.domain.lower.at(0)),
      y(z.size(), scene.domain.dimension == 3 ? scene.domain.lower.at(1) : 0.0);
  std::vector<double> value(z.size());
  sampler.sample(z.size(), x.data(), y.data(), z.data(), value.data());
  std::size_t next = 0;  // the table asks for each of these heights once, from the bottom up
  return dynamics::ReferenceProfile(bottom, top, points, [&](double) { return value[next++]; });
}

template void thin_parcels<2>(const scene::Scene&, parcels::Store&);
template void thin_parcels<3>(const scene::Scene&, parcels::Store&);
template void fill_initial_state<2>(const scene::Scene&, const mesh::Grid<2>&, parcels::Store&,
                                    dynamics::MeanWind&);
template void fill_initial_state<3>(const scene::Scene&, const mesh::Grid<3>&, parcels::Store&,
                                    dynamics::MeanWind&);

}  // namespace pileus::model

#include "dynamics/parcel_motion.hpp"

#include "base/parallel.hpp"
#include "mesh/node_heights.hpp"
#include "parcels/margin.hpp"

namespace pileus::dynamics {
namespace {

constexpr std::size_t read_ahead = 8;

void run_blunting(ShapeJob<3>& job) {
  kernels().blunt_shapes_3d(job);
}
void run_blunting(ShapeJob<2>& job) {
  kernels().blunt_shapes_2d(job);
}

}  // namespace

template <int D>
ParcelMotion<D>::ParcelMotion(const mesh::Grid<D>& grid, const LowStorageScheme& scheme,
                              ShapeIntegrator shape, ReferenceProfile reference,
                              double aspect_limit)
    : grid_(grid),
      scheme_(scheme),
      shape_(shape),
      reference_(std::move(reference)),
      aspect_limit_(aspect_limit),
      deposit_(grid),
      deposited_(grid.nodes() * mesh::DepositRecord<D>::width),
      flow_(grid.nodes() * mesh::FlowRecord<D>::width),
      offsets_(lent_arrays()) {}

/// Position increments first, then the shape's.
template <int D>
std::array<AlignedArray<double>*, parcels::SupportOffsets<D>::components>
ParcelMotion<D>::lent_arrays() {
  std::array<AlignedArray<double>*, parcels::SupportOffsets<D>::components> arrays;
  for (std::size_t c = 0; c < arrays.size(); ++c)
    arrays[c] = c < D ? &position_increment_[c] : &shape_increment_[c - D];
  return arrays;
}

template <int D>
void ParcelMotion<D>::reserve(std::size_t parcels) {
  // Room for growth, so that the parcel count may vary for many steps without an allocation. Each
  // array is looked at: sorting swaps some of them for others.
  const std::size_t room = parcels::with_margin(parcels) + read_ahead;
  const auto provide = [&](AlignedArray<double>& array) {
    if (array.size() < parcels + read_ahead) array.discard_and_resize(room);
  };
  for (auto& array : position_increment_) provide(array);
  for (auto& array : vorticity_increment_) provide(array);
  const std::size_t used = shape_ == ShapeIntegrator::exponential
                               ? shape_increment_.size()
                               : std::size_t(StageJob<D>::shape_components);
  for (std::size_t c = 0; c < used; ++c) provide(shape_increment_[c]);
  if (!reference_.is_linear()) provide(perturbation_);
}

template <int D>
void ParcelMotion<D>::deposit_state(parcels::Store& store, const double* buoyancy,
                                    const std::vector<std::size_t>& tile_begin) {
  if (!reference_.is_linear()) {
    const double* z = store.position(D - 1);
    parallel_chunks(store.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) perturbation_[p] = buoyancy[p] - reference_(z[p]);
    });
    buoyancy = perturbation_.data();
  }
  static_assert(mesh::mean_height<D> == mesh::DepositRecord<D>::buoyancy + 1);
  std::vector<const double*>& values = deposit_values_;
  values.clear();
  for (int c = 0; c < store.vorticity_components(); ++c) values.push_back(store.vorticity(c));
  values.push_back(buoyancy);
  values.push_back(store.position(D - 1));
  parcels::LinearReference reference;
  if (!reference_.is_zero() && reference_.is_linear())
    reference = {store.vorticity_components(), reference_.intercept(), reference_.slope()};
  empty_nodes_ = deposit_.means(store, tile_begin, values, reference, deposited_.data());
  mesh::refer_buoyancy_to_nodes(grid_, deposited_.data());
}

template <int D>
void ParcelMotion<D>::deposit_vorticity(const parcels::Store& store,
                                        const std::vector<std::size_t>& tile_begin) {
  deposit_values_.clear();
  for (int c = 0; c < store.vorticity_components(); ++c)
    deposit_values_.push_back(store.vorticity(c));
  deposit_.means(store, tile_begin, deposit_values_, {}, deposited_.data());
}

template <int D>
StageJob<D> ParcelMotion<D>::stage_job(parcels::Store& store, std::size_t s, double dt,
                                       bool evaluate_only) {
  StageJob<D> whole{};
  whole.grid = parcels::make_kernel_grid(grid_);
  for (int d = 0; d < D; ++d) {
    whole.position[d] = store.position(d);
    whole.position_increment[d] = position_increment_[static_cast<std::size_t>(d)].data();
  }
  for (int c = 0; c < StageJob<D>::vorticity_components; ++c) {
    whole.vorticity[c] = store.vorticity(c);
    whole.vorticity_increment[c] = vorticity_increment_[static_cast<std::size_t>(c)].data();
  }
  for (int c = 0; c < StageJob<D>::shape_components; ++c) whole.shape[c] = store.shape(c);
  for (int c = 0; c < StageJob<D>::gradient_components; ++c)
    whole.shape_increment[c] = shape_increment_[static_cast<std::size_t>(c)].data();
  whole.size_volume = store.size_volume();
  whole.keep = scheme_.a[s];
  whole.advance = evaluate_only ? 0.0 : scheme_.b[s] * dt;
  whole.first = s == 0;
  whole.last = s + 1 == scheme_.stages();
  whole.evaluate_only = evaluate_only;
  whole.aspect_limit = aspect_limit_;
  whole.shape_integrator = shape_;
  return whole;
}

template <int D>
void ParcelMotion<D>::blunt_shapes(parcels::Store& store) {
  ShapeJob<D> whole{};
  for (int c = 0; c < StageJob<D>::shape_components; ++c) whole.shape[c] = store.shape(c);
  whole.size_volume = store.size_volume();
  whole.aspect_limit = aspect_limit_;
  broken_shapes_ += ordered_reduce(
      store.size(), std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        ShapeJob<D> job = whole;
        job.begin = begin;
        job.end = end;
        run_blunting(job);
        return job.broken;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
}

template <int D>
std::size_t ParcelMotion<D>::allocated_bytes() const {
  std::size_t bytes = deposited_.allocated_bytes() + flow_.allocated_bytes() +
                      perturbation_.allocated_bytes() + deposit_.allocated_bytes();
  for (const auto& a : position_increment_) bytes += a.allocated_bytes();
  for (const auto& a : vorticity_increment_) bytes += a.allocated_bytes();
  for (const auto& a : shape_increment_) bytes += a.allocated_bytes();
  return bytes;
}

template class ParcelMotion<2>;
template class ParcelMotion<3>;

}  // namespace pileus::dynamics

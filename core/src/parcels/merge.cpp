#include "parcels/merge.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/parallel.hpp"
#include "parcels/ellipsoid.hpp"
#include "parcels/walls.hpp"

namespace pileus::parcels {
namespace {

constexpr double three_over_four_pi = 0.23873241463784300365;
constexpr double one_over_pi = 0.31830988618379067154;

template <int D>
void separation(const mesh::Grid<D>& grid, const Store& store, std::uint32_t from, std::uint32_t to,
                double (&d)[D]) {
  for (int a = 0; a < D; ++a) d[a] = store.position(a)[to] - store.position(a)[from];
  for (int a = 0; a < D - 1; ++a) d[a] = minimum_image(d[a], grid.extent[a]);
}

/// The factor that gives the ellipse or ellipsoid of a shape matrix the wanted volume.
template <int D>
double scale_to_volume(const double* shape, double volume) {
  if constexpr (D == 3) {
    const double abc = three_over_four_pi * volume;
    return std::cbrt(abc * abc /
                     baseline::determinant(baseline::Symmetric3<double>{
                         shape[0], shape[1], shape[2], shape[3], shape[4], shape[5]}));
  } else {
    const double ab = one_over_pi * volume;
    return ab / std::sqrt(baseline::determinant(
                    baseline::Symmetric2<double>{shape[0], shape[1], shape[2]}));
  }
}

/// Scales a second moment to the shape of that volume, and returns the volume of the shape. Where
/// shapes may be larger than the volume, a moment that is stays as it is.
template <int D>
double close_moment(double* shape, double volume, bool may_be_larger) {
  const double scale = scale_to_volume<D>(shape, volume);
  if (may_be_larger && scale < 1) return volume * std::pow(scale, -0.5 * D);
  for (int c = 0; c < D * (D + 1) / 2; ++c) shape[c] *= scale;
  return volume;
}

/// Vertical half-extent of a parcel's ellipse or ellipsoid.
double vertical_half_extent(const Store& store, std::uint32_t p) {
  return std::sqrt(store.shape(store.shape_components() - 1)[p]);
}

/// Turns the heights of a parcel's items from the parcel's measure into metres, or back.
void restate_heights(Store& store, std::uint32_t p, double scale, double offset) {
  ItemLists& items = store.items();
  if (items.height_column() < 0) return;
  double* height = items.column(items.height_column());
  const std::int64_t end = items.begin()[p] + items.count()[p];
  for (std::int64_t i = items.begin()[p]; i < end; ++i) height[i] = scale * height[i] + offset;
}

/// Heights of the items of a cluster's parcels in metres.
template <class Source>
void items_to_metres(Store& store, const Source* begin, const Source* end) {
  const double* z = store.position(store.dimension() - 1);
  const auto restate = [&](std::uint32_t p) {
    restate_heights(store, p, vertical_half_extent(store, p), z[p]);
  };
  restate(begin->receiver);
  for (const Source* s = begin; s != end; ++s) restate(s->source);
}

/// And back, in the measure of the receiver at its new place: items stay at the height where they
/// are.
template <class Source>
void items_to_receiver(Store& store, const Source* begin, const Source* end) {
  const std::uint32_t r = begin->receiver;
  const double inverse_extent = 1.0 / vertical_half_extent(store, r);
  const double offset = -store.position(store.dimension() - 1)[r] * inverse_extent;
  restate_heights(store, r, inverse_extent, offset);
  for (const Source* s = begin; s != end; ++s)
    restate_heights(store, s->source, inverse_extent, offset);
}

/// The largest parcel of a cluster passes its identity on; of equals, the one with the smaller.
template <class Source>
std::uint64_t identity_of_merged(const Store& store, const Source* begin, const Source* end) {
  const double* volume = store.volume();
  const std::uint64_t* uid = store.uid();
  std::uint32_t largest = begin->receiver;
  for (const Source* s = begin; s != end; ++s)
    if (volume[s->source] > volume[largest] ||
        (volume[s->source] == volume[largest] && uid[s->source] < uid[largest]))
      largest = s->source;
  return uid[largest];
}

}  // namespace

template <int D>
Merge<D>::Merge(const mesh::Grid<D>& grid, double smallest_volume)
    : grid_(grid), smallest_volume_(smallest_volume), nearest_(grid) {}

template <int D>
MergeCounts Merge<D>::run(Store& store, const CellOrder<D>& order) {
  MergeCounts counts;
  forget();
  find_links(store, order);
  counts.small = small_.size();
  if (links_.empty()) return counts;

  const std::uint64_t* uid = store.uid();
  sources_.clear();
  for (const Link& link : graph_.resolve(links_, store.size()))
    sources_.push_back({uid[link.to], uid[link.from], link.to, link.from});
  // A fixed order of summation, whatever the order in memory.
  std::sort(sources_.begin(), sources_.end(), [](const Source& a, const Source& b) {
    return std::tie(a.receiver_uid, a.receiver, a.uid) <
           std::tie(b.receiver_uid, b.receiver, b.uid);
  });
  cluster_begin_.clear();
  for (std::size_t s = 0; s < sources_.size(); ++s)
    if (s == 0 || sources_[s].receiver != sources_[s - 1].receiver) cluster_begin_.push_back(s);
  cluster_begin_.push_back(sources_.size());

  const std::size_t clusters = cluster_begin_.size() - 1;
  parallel_chunks(
      clusters,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
          merge_cluster(store, sources_.data() + cluster_begin_[c],
                        sources_.data() + cluster_begin_[c + 1]);
      },
      256);
  gone_.assign(store.size(), 0);
  for (const Source& s : sources_) gone_[s.source] = 1;
  for (std::size_t c = 0; c < clusters; ++c) {
    const std::size_t members = cluster_begin_[c + 1] - cluster_begin_[c];
    ++counts.clusters[std::min<std::size_t>(members, 7) - 1];
  }
  counts.merged = sources_.size();
  if (store.items().exist()) list_merged();
  return counts;
}

template <int D>
void Merge<D>::list_merged() {
  for (const Source& s : sources_) merged_.push_back({s.receiver, s.source});
  std::stable_sort(
      merged_.begin(), merged_.end(),
      [](const MergedParcel& a, const MergedParcel& b) { return a.receiver < b.receiver; });
}

template <int D>
void Merge<D>::find_links(const Store& store, const CellOrder<D>& order) {
  small_.clear();
  links_.clear();
  const double* volume = store.volume();
  for (const std::uint32_t p : order.order())
    if (volume[p] < smallest_volume_) small_.push_back(p);
  if (small_.empty() || store.size() < 2) return;
  std::sort(small_.begin(), small_.end(),
            [uid = store.uid()](std::uint32_t a, std::uint32_t b) { return uid[a] < uid[b]; });
  nearest_.prepare(store, order);
  links_.resize(small_.size());
  parallel_chunks(
      small_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t m = begin; m < end; ++m) links_[m] = {small_[m], nearest_.of(small_[m])};
      },
      256);
  // A parcel whose position is not a number is at no distance from anything.
  std::erase_if(links_, [](const Link& link) { return link.to == NearestParcel<D>::nobody; });
}

template <int D>
void Merge<D>::merge_cluster(Store& store, const Source* begin, const Source* end) const {
  constexpr double moment = D == 3 ? 5.0 : 4.0;  // second moment of the ellipsoid is B/(D + 2)
  constexpr int shape_components = D == 3 ? 6 : 3;
  const std::uint32_t r = begin->receiver;
  const double* volume = store.volume();
  double total = volume[r];
  for (const Source* s = begin; s != end; ++s) total += volume[s->source];
  const double inverse = 1.0 / total;

  double centroid[D] = {};  // relative to the receiver
  for (const Source* s = begin; s != end; ++s) {
    double d[D];
    separation<D>(grid_, store, r, s->source, d);
    for (int a = 0; a < D; ++a) centroid[a] += volume[s->source] * inverse * d[a];
  }
  double shape[shape_components] = {};
  const auto add_moment = [&](std::uint32_t p) {
    double d[D];
    separation<D>(grid_, store, r, p, d);
    for (int a = 0; a < D; ++a) d[a] -= centroid[a];
    const double mu = volume[p] * inverse;
    int c = 0;
    for (int a = 0; a < D; ++a)
      for (int b = a; b < D; ++b, ++c) shape[c] += mu * (store.shape(c)[p] + moment * d[a] * d[b]);
  };
  add_moment(r);
  for (const Source* s = begin; s != end; ++s) add_moment(s->source);
  const double size = close_moment<D>(shape, total, store.carries_size());
  items_to_metres(store, begin, end);

  const auto merge_mean = [&](double* value) {
    double sum = volume[r] * value[r], low = value[r], high = value[r];
    for (const Source* s = begin; s != end; ++s) {
      const double v = value[s->source];
      sum += volume[s->source] * v;
      low = std::min(low, v);
      high = std::max(high, v);
    }
    // Rounding must not carry a mean past its parents.
    value[r] = std::clamp(sum * inverse, low, high);
  };
  for (int c = 0; c < store.vorticity_components(); ++c) merge_mean(store.vorticity(c));
  for (std::size_t i = 0; i < store.scalars().size(); ++i) {
    double* value = store.scalar(static_cast<int>(i));
    if (store.scalars()[i].nature == Nature::intensive) merge_mean(value);
    if (store.scalars()[i].nature == Nature::extensive)
      for (const Source* s = begin; s != end; ++s) value[r] += value[s->source];
  }
  for (int a = 0; a < D; ++a) store.position(a)[r] += centroid[a];
  hold_inside<D>(store, grid_, r);  // across the seam, or rounded beyond a wall
  for (int c = 0; c < shape_components; ++c) store.shape(c)[r] = shape[c];
  store.uid()[r] = identity_of_merged(store, begin, end);
  store.size_volume()[r] = size;
  store.volume()[r] = total;
  items_to_receiver(store, begin, end);
}

template class Merge<2>;
template class Merge<3>;

}  // namespace pileus::parcels

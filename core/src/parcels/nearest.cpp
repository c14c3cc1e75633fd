#include "parcels/nearest.hpp"

#include <algorithm>
#include <cmath>

#include "mesh/vector_clones.hpp"

namespace pileus::parcels {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t crowd = 64;      // parcels in a cell from which a tree pays
constexpr std::uint32_t leaf_size = 12;  // parcels that are compared one by one
constexpr std::uint32_t batch = 64;      // parcels whose distances are taken at once

/// Adds to squared distances what one direction contributes.
PILEUS_VECTOR_CLONES
void add_squares(const double* coordinate, const std::uint32_t* parcel, std::uint32_t count,
                 double centre, double extent, double stretch, double* distance) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const double d = stretch * minimum_image(coordinate[parcel[i]] - centre, extent);
    distance[i] += d * d;
  }
}

}  // namespace

template <int D>
void NearestParcel<D>::prepare(const Store& store, const CellOrder<D>& order) {
  store_ = &store;
  order_ = &order;
  crowded_ = false;
  const auto cells = static_cast<std::uint32_t>(grid_.cell_count());
  for (std::uint32_t c = 0; c < cells && !crowded_; ++c)
    crowded_ = order.first(c + 1) - order.first(c) > crowd;
  if (!crowded_) return;
  ranked_.assign(order.order().begin(), order.order().end());
  root_.assign(cells, 0);
  nodes_.clear();
  for (std::uint32_t c = 0; c < cells; ++c) {
    if (order.first(c + 1) - order.first(c) <= crowd) continue;
    root_[c] = static_cast<std::uint32_t>(nodes_.size()) + 1;
    build(order.first(c), order.first(c + 1));
  }
}

/// Halves along the box's longest side, at the median.
template <int D>
void NearestParcel<D>::build(std::uint32_t begin, std::uint32_t end) {
  Node node{};
  node.begin = begin;
  node.end = end;
  node.smallest_uid = std::numeric_limits<std::uint64_t>::max();
  int longest = 0;
  for (int a = 0; a < D; ++a) {
    const double* x = store_->position(a);
    node.low[a] = infinity;
    node.high[a] = -infinity;
    for (std::uint32_t s = begin; s < end; ++s) {
      node.low[a] = std::min(node.low[a], x[ranked_[s]]);
      node.high[a] = std::max(node.high[a], x[ranked_[s]]);
    }
    if (node.high[a] - node.low[a] > node.high[longest] - node.low[longest]) longest = a;
  }
  for (std::uint32_t s = begin; s < end; ++s)
    node.smallest_uid = std::min(node.smallest_uid, store_->uid()[ranked_[s]]);
  const std::size_t place = nodes_.size();
  nodes_.push_back(node);
  if (end - begin <= leaf_size) return;
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto coordinate = [x = store_->position(longest)](std::uint32_t p) {
    return x[p] == x[p] ? x[p] : -infinity;  // what is not a number must have a place in the order
  };
  const std::uint64_t* uid = store_->uid();
  // Identities decide between equal coordinates: parcels at one point are told apart by them.
  std::nth_element(ranked_.begin() + begin, ranked_.begin() + middle, ranked_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double at = coordinate(a), bt = coordinate(b);
                     return at != bt ? at < bt : uid[a] < uid[b];
                   });
  build(begin, middle);
  nodes_[place].second_child = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

/// No parcel in the box is nearer, by the very arithmetic of consider(): each operation there is
/// monotone in the coordinate as long as the same periodic image is nearest.
template <int D>
double NearestParcel<D>::least_distance(std::uint32_t p, const Node& node) const {
  double distance = 0;
  for (int a = 0; a < D; ++a) {
    const double x = store_->position(a)[p];
    double low = node.low[a] - x, high = node.high[a] - x;
    if (a < D - 1) {
      const double extent = grid_.extent[a];
      if (periods_between(low, extent) != periods_between(high, extent)) continue;
      low = minimum_image(low, extent);
      high = minimum_image(high, extent);
    }
    if (low <= 0 && high >= 0) continue;
    const double nearest =
        metric_.stretch[std::size_t(a)] * std::min(std::abs(low), std::abs(high));
    distance += nearest * nearest;
  }
  return distance;
}

template <int D>
bool NearestParcel<D>::may_improve(double distance, std::uint64_t uid, const Best& best) const {
  return distance < best.distance ||
         (distance == best.distance && best.parcel != nobody && uid < store_->uid()[best.parcel]);
}

template <int D>
void NearestParcel<D>::consider(std::uint32_t p, std::uint32_t begin, std::uint32_t end,
                                Best& best) const {
  const std::vector<std::uint32_t>& ranked = crowded_ ? ranked_ : order_->order();
  const std::uint64_t* uid = store_->uid();
  for (std::uint32_t first = begin; first < end; first += batch) {
    const std::uint32_t count = std::min(batch, end - first);
    const std::uint32_t* parcel = ranked.data() + first;
    double distance[batch] = {};
    for (int a = 0; a < D; ++a)
      add_squares(store_->position(a), parcel, count, store_->position(a)[p],
                  a < D - 1 ? grid_.extent[a] : infinity, metric_.stretch[std::size_t(a)],
                  distance);
    for (std::uint32_t i = 0; i < count; ++i)
      if (distance[i] <= best.distance && parcel[i] != p &&
          may_improve(distance[i], uid[parcel[i]], best))
        best = {distance[i], parcel[i]};
  }
}

/// The nearer child first; of equally near ones that with the smaller identity, which alone is of
/// interest then.
template <int D>
void NearestParcel<D>::descend(std::uint32_t p, std::uint32_t place, Best& best) const {
  const Node& node = nodes_[place];
  if (node.second_child == 0) return consider(p, node.begin, node.end, best);
  std::uint32_t child[2] = {place + 1, node.second_child};
  double distance[2] = {least_distance(p, nodes_[child[0]]), least_distance(p, nodes_[child[1]])};
  if (distance[1] < distance[0] ||
      (distance[1] == distance[0] &&
       nodes_[child[1]].smallest_uid < nodes_[child[0]].smallest_uid)) {
    std::swap(child[0], child[1]);
    std::swap(distance[0], distance[1]);
  }
  for (int c = 0; c < 2; ++c)
    if (best.parcel == nobody || may_improve(distance[c], nodes_[child[c]].smallest_uid, best))
      descend(p, child[c], best);
}

template <int D>
void NearestParcel<D>::consider_cell(std::uint32_t p, const std::array<int, D>& cell,
                                     Best& best) const {
  const int nx = grid_.nx(), ny = grid_.ny();
  const int i = cell[0], j = D == 3 ? cell[1] : 0;
  const std::size_t key = order_->key((i % nx + nx) % nx, (j % ny + ny) % ny, cell[D - 1]);
  if (!crowded_ || root_[key] == 0)
    consider(p, order_->first(key), order_->first(key + 1), best);
  else
    descend(p, root_[key] - 1, best);
}

/// The parcel's own cell first: what it holds is often nearer than anything beyond its faces.
template <int D>
void NearestParcel<D>::search_around(std::uint32_t p, const std::array<double, D>& xi,
                                     const std::array<int, D>& node, Best& best) const {
  constexpr double rounding = 1e-9;  // of places measured in cells, far more than theirs
  std::array<int, D> own;
  std::array<double, D> beyond;  // least squared distance of what lies beyond the nearest face
  for (std::size_t a = 0; a < D; ++a) {
    own[a] = xi[a] >= node[a] ? node[a] : node[a] - 1;
    const double cells = std::max(0.0, std::abs(xi[a] - node[a]) - rounding);
    const double length = cells * grid_.spacing[a] * metric_.stretch[a];
    beyond[a] = length * length * (1 - rounding);
  }
  for (unsigned n = 0; n < 1u << D; ++n) {
    std::array<int, D> cell;
    double least = 0;
    for (std::size_t a = 0; a < D; ++a) {
      const bool other = n >> a & 1u;
      cell[a] = other ? 2 * node[a] - 1 - own[a] : own[a];
      least += other ? beyond[a] : 0.0;
    }
    if (cell[D - 1] < 0 || cell[D - 1] >= grid_.nz() || least > best.distance) continue;
    consider_cell(p, cell, best);
  }
}

template <int D>
std::uint32_t NearestParcel<D>::of(std::uint32_t p) const {
  std::array<int, D> node;
  std::array<double, D> xi;
  for (std::size_t a = 0; a < D; ++a) {
    xi[a] = (store_->position(int(a))[p] - grid_.lower[a]) * grid_.inverse_spacing[a];
    // Nowhere: not a number, or so far out that distances mean nothing. Searching would take long.
    if (!(std::abs(xi[a]) < 1e9)) return nobody;
    node[a] = static_cast<int>(std::lround(xi[a]));
  }
  Best best;
  search_around(p, xi, node, best);
  const int ci = node[0], cj = D == 3 ? node[1] : 0, ck = node[D - 1];
  const int nz = grid_.nz(), widest = std::max({grid_.nx(), grid_.ny(), nz}) + 1;
  for (int radius = 2; best.parcel == nobody && radius <= widest; ++radius)
    for (int j = D == 3 ? cj - radius : 0; j < (D == 3 ? cj + radius : 1); ++j)
      for (int i = ci - radius; i < ci + radius; ++i)
        for (int k = std::max(ck - radius, 0); k < std::min(ck + radius, nz); ++k) {
          if constexpr (D == 3)
            consider_cell(p, {i, j, k}, best);
          else
            consider_cell(p, {i, k}, best);
        }
  return best.parcel;
}

template class NearestParcel<2>;
template class NearestParcel<3>;

}  // namespace pileus::parcels

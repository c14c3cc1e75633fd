#include "parcels/nearest.hpp"

#include <algorithm>
#include <cmath>

namespace pileus::parcels {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t crowd = 64;      // parcels in a cell from which a tree pays
constexpr std::uint32_t leaf_size = 12;  // parcels that are compared one by one

}  // namespace

double minimum_image(double difference, double extent) {
  return difference - extent * std::round(difference / extent);
}

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
      if (std::round(low / extent) != std::round(high / extent)) continue;
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
  for (std::uint32_t s = begin; s < end; ++s) {
    const std::uint32_t q = ranked[s];
    if (q == p) continue;
    double distance = 0;
    for (int a = 0; a < D; ++a) {
      double d = store_->position(a)[q] - store_->position(a)[p];
      if (a < D - 1) d = minimum_image(d, grid_.extent[a]);
      d *= metric_.stretch[std::size_t(a)];
      distance += d * d;
    }
    if (may_improve(distance, uid[q], best)) best = {distance, q};
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
std::uint32_t NearestParcel<D>::of(std::uint32_t p) const {
  int nearest_node[D];
  for (int a = 0; a < D; ++a) {
    const double xi = (store_->position(a)[p] - grid_.lower[a]) * grid_.inverse_spacing[a];
    // Nowhere: not a number, or so far out that distances mean nothing. Searching would take long.
    if (!(std::abs(xi) < 1e9)) return nobody;
    nearest_node[a] = static_cast<int>(std::lround(xi));
  }
  const int ci = nearest_node[0], cj = D == 3 ? nearest_node[1] : 0, ck = nearest_node[D - 1];
  const int nx = grid_.nx(), ny = grid_.ny(), nz = grid_.nz();
  Best best;
  const auto consider_cell = [&](int i, int j, int k) {
    const std::size_t key = order_->key((i % nx + nx) % nx, (j % ny + ny) % ny, k);
    if (!crowded_ || root_[key] == 0)
      consider(p, order_->first(key), order_->first(key + 1), best);
    else
      descend(p, root_[key] - 1, best);
  };
  const int widest = std::max({nx, ny, nz}) + 1;
  for (int radius = 1; best.parcel == nobody && radius <= widest; ++radius)
    for (int j = D == 3 ? cj - radius : 0; j < (D == 3 ? cj + radius : 1); ++j)
      for (int i = ci - radius; i < ci + radius; ++i)
        for (int k = std::max(ck - radius, 0); k < std::min(ck + radius, nz); ++k)
          consider_cell(i, j, k);
  return best.parcel;
}

template class NearestParcel<2>;
template class NearestParcel<3>;

}  // namespace pileus::parcels

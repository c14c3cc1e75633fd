// Mixing between parcels that overlap, or nearly do, at the rate of the strain.
#include <pileus/mixed_scalars.hpp>
#include <pileus/plugin.hpp>

#include <algorithm>
#include <array>
#include <limits>

#include "contact.hpp"
#include "exchange.hpp"
#include "neighbours.hpp"

namespace pileus::overlap {
namespace {

/// The parcels of one call, with directions in order.
template <int D>
struct Parcels {
  const double *position[D], *shape[D * (D + 1) / 2], *volume, *strain;
  const std::uint64_t* uid;

  Symmetric<D> shape_of(std::int64_t p) const {
    Symmetric<D> b;
    for (std::size_t c = 0; c < b.size(); ++c) b[c] = shape[c][p];
    return b;
  }
  /// A bound on the longest semi-axis: a² ≤ tr B.
  double reach(std::int64_t p) const {
    double trace = shape[0][p];
    if constexpr (D == 3)
      trace += shape[3][p] + shape[5][p];
    else
      trace += shape[2][p];
    return std::sqrt(trace);
  }
};

/// Exchanged volumes of every parcel with every neighbour; each pair stands in both lists.
struct Pairs {
  std::span<std::int64_t> begin;  // of a parcel's neighbours
  std::span<std::int64_t> neighbour;
  std::span<double> volume;
  std::span<double> limit;  // per parcel
};

class OverlapExchange : public Operator<OverlapExchange> {
 public:
  void describe(Declaration& d) {
    describe_operator(d);
    describe_parameters(d);
    position_[0] = d.reads("x_position", "m").doc("of the parcel's centre");
    position_[1] = d.reads("y_position", "m").optional().doc("in three dimensions");
    position_[2] = d.reads("z_position", "m").doc("of the parcel's centre");
    constexpr std::array<const char*, 6> names = {"shape_xx", "shape_xy", "shape_xz",
                                                  "shape_yy", "shape_yz", "shape_zz"};
    for (std::size_t c = 0; c < 6; ++c)
      shape_[c] = d.reads(names[c], "m2").optional().doc("component of the shape matrix");
    volume_ = d.reads("parcel_volume", "m3").doc("of the parcel");
    strain_ = d.reads_mesh_at_parcel("strain_rate_magnitude", "s-1").doc("of the gridded flow");
    for (std::size_t i = 0; i < mixed_scalars.size(); ++i)
      scalar_[i] = d.updates(mixed_scalars[i].name, mixed_scalars[i].units)
                       .optional()
                       .doc("mixed if carried");
  }

  void apply(const pileus_step& step, Block block) const {
    if (value(rate_) == 0) return;
    if (block.raw().grid == nullptr) throw Failure("it needs a mesh, which this run does not have");
    if (block.has(position_[1]))
      exchange<3>(step, block);
    else
      exchange<2>(step, block);
  }

 private:
  static void describe_operator(Declaration& d) {
    d.op.id = "org.pileus.overlap_exchange";
    d.op.kind = "mixing";
    d.op.version = "1.0.0";
    d.op.title = "Exchange between overlapping parcels";
    d.op.summary =
        "Exchanges scalars between ellipsoids that overlap or nearly touch, conserving and "
        "monotone for any time step.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("small_scale_mixing");
    d.cites("10.1016/0021-9991(85)90171-8", "Perram & Wertheim 1985: the contact function");
    d.cites(nullptr, "Gilitschenski & Hanebeck 2012: a robust test for overlapping ellipsoids");
  }
  void describe_parameters(Declaration& d) {
    static constexpr double rates[] = {0.0, 0.1, 0.3,
                                       1.0, 3.0, std::numeric_limits<double>::quiet_NaN()};
    rate_ = d.number("rate", "1", 1.0)
                .range(0.0, 100.0)
                .knob(rates)
                .doc("exchange rate of coinciding parcels over the strain rate |S|");
    margin_ = d.number("margin", "1", 0.0)
                  .range(0.0, 1.0)
                  .doc("growth of both ellipsoids up to which they still exchange");
  }

  template <int D>
  Parcels<D> parcels(Block block) const {
    constexpr std::size_t plane[3] = {0, 2, 5};
    Parcels<D> set{};
    for (int d = 0; d < D; ++d)
      set.position[d] = block.in(position_[d == D - 1 ? 2 : static_cast<std::size_t>(d)]);
    for (std::size_t c = 0; c < D * (D + 1) / 2; ++c)
      set.shape[c] = block.in(shape_[D == 3 ? c : plane[c]]);
    set.volume = block.in(volume_);
    set.strain = block.in(strain_);
    set.uid = block.raw().uid;
    return set;
  }

  template <class T>
  std::span<T> room(Block block, std::int64_t count) const {
    static_assert(sizeof(T) == sizeof(double));
    return {reinterpret_cast<T*>(block.scratch(static_cast<std::size_t>(count)).data()),
            static_cast<std::size_t>(count)};
  }

  template <int D>
  void exchange(const pileus_step& step, Block block) const {
    const Parcels<D> set = parcels<D>(block);
    const Cells<D> cells(*block.raw().grid);
    const CellLists lists = list_by_cell(block, set, cells);
    const Pairs pairs = find_pairs(step, block, set, cells, lists);
    const std::span<double> old = room<double>(block, block.count());
    for (const Slot slot : scalar_) {
      if (!block.has(slot)) continue;
      double* value = block.out(slot);
      std::copy_n(value, block.count(), old.begin());
      parallel_for(block.count(),
                   [&](std::int64_t p) { value[p] = mixed(pairs, old, set.volume[p], p); });
    }
  }

  template <int D>
  CellLists list_by_cell(Block block, const Parcels<D>& set, const Cells<D>& cells) const {
    const std::int64_t n = block.count(), total = cells.total();
    CellLists lists{room<std::int64_t>(block, total + 1), room<std::int64_t>(block, n)};
    const std::span<std::int64_t> cell = room<std::int64_t>(block, n);
    parallel_for(n, [&](std::int64_t p) {
      std::int64_t at[D];
      for (int d = 0; d < D; ++d) at[d] = cells.along(d, set.position[d][p]);
      cell[p] = cell_index(cells, at);
    });
    std::fill(lists.begin.begin(), lists.begin.end(), 0);
    for (std::int64_t p = 0; p < n; ++p) ++lists.begin[cell[p] + 1];
    for (std::int64_t c = 0; c < total; ++c) lists.begin[c + 1] += lists.begin[c];
    const std::span<std::int64_t> next = room<std::int64_t>(block, total);
    std::copy_n(lists.begin.begin(), total, next.begin());
    for (std::int64_t p = 0; p < n; ++p) lists.parcel[next[cell[p]]++] = p;
    return lists;
  }

  /// Calls visit(q) for the parcels around p whose spheres of radius `reach` come near enough.
  template <int D, class Visit>
  void each_candidate(const Parcels<D>& set, const Cells<D>& cells, const CellLists& lists,
                      std::int64_t p, Visit&& visit) const {
    const double growth = 1.0 + value(margin_), own = set.reach(p);
    std::int64_t centre[D];
    for (int d = 0; d < D; ++d) centre[d] = cells.along(d, set.position[d][p]);
    around(cells, centre, [&](std::int64_t cell) {
      for (std::int64_t k = lists.begin[cell]; k < lists.begin[cell + 1]; ++k) {
        const std::int64_t q = lists.parcel[k];
        if (q == p) continue;
        double squared = 0;
        for (int d = 0; d < D; ++d) {
          const double apart = cells.separation(d, set.position[d][p], set.position[d][q]);
          squared += apart * apart;
        }
        const double near = growth * (own + set.reach(q));
        if (squared < near * near) visit(q);
      }
    });
  }

  template <int D>
  Pairs find_pairs(const pileus_step& step, Block block, const Parcels<D>& set,
                   const Cells<D>& cells, const CellLists& lists) const {
    const std::int64_t n = block.count();
    Pairs pairs{room<std::int64_t>(block, n + 1), {}, {}, room<double>(block, n)};
    parallel_for(n, [&](std::int64_t p) {
      std::int64_t count = 0;
      each_candidate(set, cells, lists, p, [&](std::int64_t) { ++count; });
      pairs.begin[p + 1] = count;
    });
    pairs.begin[0] = 0;
    for (std::int64_t p = 0; p < n; ++p) pairs.begin[p + 1] += pairs.begin[p];
    const std::int64_t all = std::max<std::int64_t>(pairs.begin[n], 1);
    pairs.neighbour = room<std::int64_t>(block, all);
    pairs.volume = room<double>(block, all);
    parallel_for(n, [&](std::int64_t p) {
      std::int64_t at = pairs.begin[p];
      double total = 0;
      each_candidate(set, cells, lists, p, [&](std::int64_t q) {
        pairs.neighbour[at] = q;
        pairs.volume[at] = exchanged(step, set, cells, p, q);
        total += pairs.volume[at++];
      });
      pairs.limit[p] = exchange_limit(total, set.volume[p]);
    });
    return pairs;
  }

  /// The same bits from either side: the pair is looked at from the lower identity.
  template <int D>
  double exchanged(const pileus_step& step, const Parcels<D>& set, const Cells<D>& cells,
                   std::int64_t p, std::int64_t q) const {
    if (set.uid[q] < set.uid[p]) std::swap(p, q);
    const double rate = 0.5 * value(rate_) * (set.strain[p] + set.strain[q]);
    if (!(rate > 0)) return 0;
    Vector<D> apart;
    for (int d = 0; d < D; ++d)
      apart[d] = cells.separation(d, set.position[d][p], set.position[d][q]);
    const double growth = 1.0 + value(margin_);
    const Contact contact =
        contact_function<D>(set.shape_of(p), set.shape_of(q), apart, growth * growth);
    return exchanged_volume(rate * nearness(contact.value, value(margin_)), step.dt, set.volume[p],
                            set.volume[q]);
  }

  static double mixed(const Pairs& pairs, std::span<const double> old, double volume,
                      std::int64_t p) {
    double gain = 0, low = old[p], high = old[p];
    for (std::int64_t k = pairs.begin[p]; k < pairs.begin[p + 1]; ++k) {
      const std::int64_t q = pairs.neighbour[k];
      const double amount = pairs.volume[k] * std::min(pairs.limit[p], pairs.limit[q]);
      if (amount == 0) continue;
      gain += amount * (old[q] - old[p]);
      low = std::min(low, old[q]);
      high = std::max(high, old[q]);
    }
    // The bounds take away rounding alone.
    return std::clamp(old[p] + gain / volume, low, high);
  }

  std::array<Slot, 3> position_;
  std::array<Slot, 6> shape_;
  std::array<Slot, mixed_scalars.size()> scalar_;
  Slot volume_, strain_;
  Param rate_, margin_;
};

}  // namespace
}  // namespace pileus::overlap

PILEUS_PLUGIN(pileus::overlap::OverlapExchange, "org.pileus.overlap_exchange", "1.0.0");

// Where the support points of eight parcels fall on the mesh, and with which weights.
//
// Shared by deposit (parcel to grid) and interpolation (grid to parcel), which must use the same
// weights for the pair to conserve. Horizontal directions wrap; vertically a point may reach one
// halo level beyond a wall and is held there, so that weights always sum to one.
#pragma once
#include "parcels/ellipsoid.hpp"
#include "parcels/kernel_grid.hpp"
#include "parcels/simd_twin.hpp"

namespace pileus::PILEUS_ISA {

using parcels::KernelGrid;

template <int D>
inline constexpr int support_points = D == 3 ? 4 : 2;
/// Columns of nodes around a cell; each contributes two levels.
template <int D>
inline constexpr int corner_columns = D == 3 ? 4 : 2;

/// Cell and position in it along one periodic direction.
struct PeriodicIndex {
  IntPack low, high;  // node indices on either side, in [0, n)
  Pack fraction;
};
static inline PeriodicIndex locate_periodic(Pack x, double lower, double inverse_spacing, double n,
                                            double inverse_n, std::int32_t cells) {
  Pack xi = (x - lower) * inverse_spacing;
  // Exact for any number of domain lengths away; rounding at the seam is caught by the clamp.
  xi = xi - n * round_down(xi * inverse_n);
  PeriodicIndex index;
  index.low = floor_to_int(xi);
  // A value that is not a number lands in cell 0 instead of outside the mesh.
  index.low = index.low < 0 ? IntPack{} : index.low;
  index.low = index.low > cells - 1 ? IntPack{} + (cells - 1) : index.low;
  index.fraction = xi - to_pack(index.low);
  index.high = index.low + 1;
  index.high = index.high == cells ? IntPack{} : index.high;
  return index;
}

struct WallIndex {
  IntPack low;  // stored level (k + 1) of the node below
  Pack fraction;
};
static inline WallIndex locate_vertical(Pack z, double lower, double inverse_spacing,
                                        std::int32_t cells) {
  Pack xi = (z - lower) * inverse_spacing;
  // The order of arguments lets a value that is not a number through to the weights, where it
  // shows.
  xi = maximum(broadcast(-1.0), xi);
  xi = minimum(broadcast(cells + 1.0), xi);
  WallIndex index;
  IntPack k = floor_to_int(xi);
  k = k < -1 ? IntPack{} - 1 : k;
  k = k > cells ? IntPack{} + cells : k;  // the top halo level itself belongs to the last interval
  index.fraction = xi - to_pack(k);
  index.low = k + 1;
  return index;
}

/// Node indices and weights of all support points of eight parcels. For each corner column the
/// node below; the node above follows it in memory.
template <int D>
struct Stencil {
  alignas(64) std::int32_t node[support_points<D>][corner_columns<D>][lanes];
  alignas(64) double weight[support_points<D>][2 * corner_columns<D>][lanes];
  /// Base cell of every point, for the test whether a tile may write there.
  alignas(64) std::int32_t cell[support_points<D>][D - 1][lanes];
  /// Bit per lane whose points all lie in one cell, and the sums of the points' weights, valid for
  /// those lanes: the nodes of point 0 with these weights stand for all points.
  unsigned together;
  alignas(64) double weight_sum[2 * corner_columns<D>][lanes];
};

static inline void put(std::int32_t* to, IntPack value) {
  *reinterpret_cast<IntPack*>(to) = value;
}
static inline void put(double* to, Pack value) {
  *reinterpret_cast<Pack*>(to) = value;
}

/// Fills the entries of one point at (x, y, z); `share` is the point's part of the parcel.
static inline void place_point(const KernelGrid<3>& grid, Pack x, Pack y, Pack z, double share,
                               int point, Stencil<3>& stencil) {
  const PeriodicIndex i = locate_periodic(x, grid.lower[0], grid.inverse_spacing[0],
                                          grid.cells_real[0], grid.inverse_cells[0], grid.cells[0]);
  const PeriodicIndex j = locate_periodic(y, grid.lower[1], grid.inverse_spacing[1],
                                          grid.cells_real[1], grid.inverse_cells[1], grid.cells[1]);
  const WallIndex k = locate_vertical(z, grid.lower[2], grid.inverse_spacing[2], grid.cells[2]);
  const IntPack row_low = j.low * grid.cells[0], row_high = j.high * grid.cells[0];
  put(stencil.node[point][0], (row_low + i.low) * grid.levels + k.low);
  put(stencil.node[point][1], (row_low + i.high) * grid.levels + k.low);
  put(stencil.node[point][2], (row_high + i.low) * grid.levels + k.low);
  put(stencil.node[point][3], (row_high + i.high) * grid.levels + k.low);
  const Pack above = share * k.fraction, below = share - above;
  // Products, not differences: no weight may be negative, however little.
  const Pack fx = i.fraction, fy = j.fraction, gx = 1.0 - fx, gy = 1.0 - fy;
  const Pack w00 = gx * gy, w10 = fx * gy, w01 = gx * fy, w11 = fx * fy;
  put(stencil.weight[point][0], w00 * below);
  put(stencil.weight[point][1], w00 * above);
  put(stencil.weight[point][2], w10 * below);
  put(stencil.weight[point][3], w10 * above);
  put(stencil.weight[point][4], w01 * below);
  put(stencil.weight[point][5], w01 * above);
  put(stencil.weight[point][6], w11 * below);
  put(stencil.weight[point][7], w11 * above);
  put(stencil.cell[point][0], i.low);
  put(stencil.cell[point][1], j.low);
}
static inline void place_point(const KernelGrid<2>& grid, Pack x, Pack z, double share, int point,
                               Stencil<2>& stencil) {
  const PeriodicIndex i = locate_periodic(x, grid.lower[0], grid.inverse_spacing[0],
                                          grid.cells_real[0], grid.inverse_cells[0], grid.cells[0]);
  const WallIndex k = locate_vertical(z, grid.lower[1], grid.inverse_spacing[1], grid.cells[1]);
  put(stencil.node[point][0], i.low * grid.levels + k.low);
  put(stencil.node[point][1], i.high * grid.levels + k.low);
  const Pack above = share * k.fraction, below = share - above;
  put(stencil.weight[point][0], below - i.fraction * below);
  put(stencil.weight[point][1], above - i.fraction * above);
  put(stencil.weight[point][2], i.fraction * below);
  put(stencil.weight[point][3], i.fraction * above);
  put(stencil.cell[point][0], i.low);
}

/// Most parcels are compact and have all points in one cell, at a quarter of the node accesses.
template <int D>
static inline void gather_points(Stencil<D>& stencil) {
  IntPack apart{};
  const IntPack first = *reinterpret_cast<const IntPack*>(stencil.node[0][0]);
  for (int s = 1; s < support_points<D>; ++s)
    apart |= first != *reinterpret_cast<const IntPack*>(stencil.node[s][0]);
  stencil.together = zero_lanes(apart);
  for (int c = 0; c < 2 * corner_columns<D>; ++c) {
    Pack sum = *reinterpret_cast<const Pack*>(stencil.weight[0][c]);
    for (int s = 1; s < support_points<D>; ++s)
      sum += *reinterpret_cast<const Pack*>(stencil.weight[s][c]);
    put(stencil.weight_sum[c], sum);
  }
}

/// Calls visit(node, weight below, weight above) for every corner column of a lane's points.
template <int D, class Visit>
static inline void for_each_column(const Stencil<D>& stencil, int lane, Visit&& visit) {
  if (stencil.together >> lane & 1u) {
    for (int c = 0; c < corner_columns<D>; ++c)
      visit(stencil.node[0][c][lane], stencil.weight_sum[2 * c][lane],
            stencil.weight_sum[2 * c + 1][lane]);
    return;
  }
  for (int s = 0; s < support_points<D>; ++s)
    for (int c = 0; c < corner_columns<D>; ++c)
      visit(stencil.node[s][c][lane], stencil.weight[s][2 * c][lane],
            stencil.weight[s][2 * c + 1][lane]);
}

static inline void place_points(const KernelGrid<3>& grid, Pack x, Pack y, Pack z,
                                const SupportOffsets3<Pack>& offset, Stencil<3>& stencil) {
  const Vector3<Pack>&p = offset.first, &q = offset.second;
  place_point(grid, x + p.x, y + p.y, z + p.z, 0.25, 0, stencil);
  place_point(grid, x + q.x, y + q.y, z + q.z, 0.25, 1, stencil);
  place_point(grid, x - p.x, y - p.y, z - p.z, 0.25, 2, stencil);
  place_point(grid, x - q.x, y - q.y, z - q.z, 0.25, 3, stencil);
  gather_points(stencil);
}
static inline void place_points(const KernelGrid<2>& grid, Pack x, Pack z,
                                const SupportOffsets2<Pack>& offset, Stencil<2>& stencil) {
  place_point(grid, x + offset.x, z + offset.z, 0.5, 0, stencil);
  place_point(grid, x - offset.x, z - offset.z, 0.5, 1, stencil);
  gather_points(stencil);
}

static inline Symmetric3<Pack> load_shape_3d(const double* const* shape, std::size_t p) {
  return {load(shape[0] + p), load(shape[1] + p), load(shape[2] + p),
          load(shape[3] + p), load(shape[4] + p), load(shape[5] + p)};
}
static inline Symmetric2<Pack> load_shape_2d(const double* const* shape, std::size_t p) {
  return {load(shape[0] + p), load(shape[1] + p), load(shape[2] + p)};
}
static inline Symmetric3<Twin> load_shapes_3d(const double* const* shape, std::size_t p) {
  return {load_twin(shape[0] + p), load_twin(shape[1] + p), load_twin(shape[2] + p),
          load_twin(shape[3] + p), load_twin(shape[4] + p), load_twin(shape[5] + p)};
}

/// Support offsets of a few groups of parcels, computed ahead of their use: interleaved with the
/// node accesses they would only wait for each other.
template <int D>
struct OffsetBlock {
  static constexpr int components = D == 3 ? 6 : 2;
  static constexpr std::size_t parcels = 64;
  alignas(64) double offset[components][parcels];

  /// Of the parcels from `begin` on, up to `end` and at most as many as fit.
  void fill(const double* const* shape, std::size_t begin, std::size_t end) {
    std::size_t n = 0;
    const std::size_t count = end - begin < parcels ? end - begin : parcels;
    if constexpr (D == 3) {
      for (; n + lanes < count; n += 2 * lanes)
        keep(n, support_offsets(load_shapes_3d(shape, begin + n)));
      for (; n < count; n += lanes) keep(n, support_offsets(load_shape_3d(shape, begin + n)));
    } else {
      for (; n < count; n += lanes) {
        const auto o = support_offsets(load_shape_2d(shape, begin + n));
        put(offset[0] + n, o.x);
        put(offset[1] + n, o.z);
      }
    }
  }

 private:
  template <class T>
  void keep(std::size_t n, const SupportOffsets3<T>& o) {
    const T values[6] = {o.first.x, o.first.y, o.first.z, o.second.x, o.second.y, o.second.z};
    for (int c = 0; c < 6; ++c) store(offset[c] + n, values[c]);
  }
};

/// Points of parcels p … p + 7 of a job: from its stored offsets, or else from the shapes by way of
/// `block`, which has to see the parcels in order from job.begin on. Both give the same bits.
template <int D, class Job>
static inline void place_points(const Job& job, std::size_t p, OffsetBlock<D>& block,
                                Stencil<D>& stencil) {
  const double* offset[OffsetBlock<D>::components];
  const std::size_t place = (p - job.begin) % OffsetBlock<D>::parcels;
  if (job.offset[0] != nullptr) {
    for (int c = 0; c < OffsetBlock<D>::components; ++c) offset[c] = job.offset[c] + p;
  } else {
    if (place == 0) block.fill(job.shape, p, job.end);
    for (int c = 0; c < OffsetBlock<D>::components; ++c) offset[c] = block.offset[c] + place;
  }
  const auto position = [&](int d) { return load(job.position[d] + p); };
  if constexpr (D == 3)
    place_points(job.grid, position(0), position(1), position(2),
                 SupportOffsets3<Pack>{{load(offset[0]), load(offset[1]), load(offset[2])},
                                       {load(offset[3]), load(offset[4]), load(offset[5])}},
                 stencil);
  else
    place_points(job.grid, position(0), position(1),
                 SupportOffsets2<Pack>{load(offset[0]), load(offset[1])}, stencil);
}

}  // namespace pileus::PILEUS_ISA

// Vector kernels of the parcel layer; compiled once per instruction set (see pileus_add_kernels).
#include "parcels/kernels.hpp"
#include "parcels/stencil.hpp"

namespace pileus::PILEUS_ISA {
namespace {

using parcels::CompressJob;
using parcels::DepositJob;
using parcels::DisplaceJob;
using parcels::InterpolateJob;

// ---- support points ------------------------------------------------------------------------

void offsets_3d(const double* const* shape, double* const* offset, std::size_t begin,
                std::size_t end) {
  for (std::size_t p = begin; p < end; p += lanes) {
    const auto o = support_offsets(load_shape_3d(shape, p));
    store(offset[0] + p, o.first.x);
    store(offset[1] + p, o.first.y);
    store(offset[2] + p, o.first.z);
    store(offset[3] + p, o.second.x);
    store(offset[4] + p, o.second.y);
    store(offset[5] + p, o.second.z);
  }
}
void offsets_2d(const double* const* shape, double* const* offset, std::size_t begin,
                std::size_t end) {
  for (std::size_t p = begin; p < end; p += lanes) {
    const auto o = support_offsets(load_shape_2d(shape, p));
    store(offset[0] + p, o.x);
    store(offset[1] + p, o.z);
  }
}

void ratios_3d(const double* const* shape, double* longest, double* ratio, std::size_t begin,
               std::size_t end) {
  for (std::size_t p = begin; p < end; p += lanes) {
    const auto axes = principal_axes(load_shape_3d(shape, p));
    store(longest + p, axes.a2);
    store(ratio + p, axes.a2 / axes.c2);
  }
}
void ratios_2d(const double* const* shape, double* longest, double* ratio, std::size_t begin,
               std::size_t end) {
  for (std::size_t p = begin; p < end; p += lanes) {
    const auto axes = principal_axes(load_shape_2d(shape, p));
    store(longest + p, axes.a2);
    store(ratio + p, axes.a2 / axes.b2);
  }
}

// ---- deposit -------------------------------------------------------------------------------

/// Bit per lane whose points all lie where the tile may write.
template <int D>
unsigned lanes_inside(const DepositJob<D>& job, const Stencil<D>& stencil) {
  IntPack outside{};
  for (int s = 0; s < support_points<D>; ++s)
    for (int d = 0; d < D - 1; ++d) {
      IntPack distance = *reinterpret_cast<const IntPack*>(stencil.cell[s][d]) - job.tile_first[d];
      distance = distance < 0 ? distance + job.grid.cells[d] : distance;
      outside |= distance >= job.tile_count[d];
    }
  return zero_lanes(outside);
}

/// Records what one group of eight leaves out; returns the lanes to deposit.
template <int D>
unsigned sort_out_strays(DepositJob<D>& job, const Stencil<D>& stencil, std::size_t p) {
  const std::size_t left = job.end - p;
  const unsigned valid = left >= lanes ? 0xffu : (1u << left) - 1u;
  const unsigned inside = lanes_inside<D>(job, stencil) & valid;
  if (inside != valid) [[unlikely]]
    for (int lane = 0; lane < lanes; ++lane)
      if ((valid & ~inside) >> lane & 1u)
        job.strays[job.stray_count++] = static_cast<std::uint32_t>(p + unsigned(lane));
  return inside;
}

/// What consecutive parcels of one cell have for its nodes, on its way to the mesh: cells hold
/// several parcels, and nodes are read and written once for all of them.
class CellRun {
 public:
  explicit CellRun(double* field) : field_(field) {}
  ~CellRun() { flush(); }
  CellRun(const CellRun&) = delete;
  CellRun& operator=(const CellRun&) = delete;

  /// Adds a lane whose points all lie in one cell.
  void add(const Stencil<3>& stencil, int lane, Pack value) {
    if (stencil.node[0][0][lane] != node_[0]) {
      flush();
      for (int c = 0; c < columns; ++c) {
        node_[c] = stencil.node[0][c][lane];
        below_[c] = above_[c] = Pack{};
      }
    }
    for (int c = 0; c < columns; ++c) {
      below_[c] += stencil.weight_sum[2 * c][lane] * value;
      above_[c] += stencil.weight_sum[2 * c + 1][lane] * value;
    }
  }

 private:
  static constexpr int columns = corner_columns<3>;

  void flush() {
    if (node_[0] < 0) return;
    for (int c = 0; c < columns; ++c) {
      Pack* node = reinterpret_cast<Pack*>(field_) + node_[c];
      node[0] += below_[c];
      node[1] += above_[c];
    }
    node_[0] = -1;
  }

  double* field_;
  std::int32_t node_[columns] = {-1, -1, -1, -1};
  Pack below_[columns], above_[columns];
};

void deposit_3d(DepositJob<3>& job) {
  Stencil<3> stencil;
  OffsetBlock<3> block;
  CellRun run(job.field);
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    place_points(job, p, block, stencil);
    const unsigned inside = sort_out_strays<3>(job, stencil, p);
    Pack record[8];
    record[0] = load(job.volume + p);
    for (int f = 0; f < 7; ++f)
      record[f + 1] = f < job.value_count ? record[0] * load(job.value[f] + p) : Pack{};
    if (job.reference_value >= 0)
      record[job.reference_value + 1] -=
          record[0] * (job.reference_intercept + job.reference_slope * load(job.position[2] + p));
    transpose(record);
    for (int lane = 0; lane < lanes; ++lane) {
      if (!(inside >> lane & 1u)) continue;
      const Pack value = record[lane];
      if (stencil.together >> lane & 1u) {
        run.add(stencil, lane, value);
        continue;
      }
      for_each_column(stencil, lane, [&](std::int32_t at, double below, double above) {
        Pack* node = reinterpret_cast<Pack*>(job.field) + at;
        node[0] += below * value;
        node[1] += above * value;
      });
    }
  }
}

typedef double Record2 __attribute__((vector_size(32)));

void deposit_2d(DepositJob<2>& job) {
  Stencil<2> stencil;
  OffsetBlock<2> block;
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    place_points(job, p, block, stencil);
    const unsigned inside = sort_out_strays<2>(job, stencil, p);
    for (int lane = 0; lane < lanes; ++lane) {
      if (!(inside >> lane & 1u)) continue;
      const double volume = job.volume[p + lane];
      Record2 value{volume, 0, 0, 0};
      for (int f = 0; f < 3; ++f)
        if (f < job.value_count) value[f + 1] = volume * job.value[f][p + lane];
      if (job.reference_value >= 0)
        value[job.reference_value + 1] -=
            volume * (job.reference_intercept + job.reference_slope * job.position[1][p + lane]);
      for_each_column(stencil, lane, [&](std::int32_t at, double below, double above) {
        Record2* node = reinterpret_cast<Record2*>(job.field) + at;
        node[0] += below * value;
        node[1] += above * value;
      });
    }
  }
}

/// Adds volume times weight to the nodes of one lane's points.
template <int D>
void add_volume(const Stencil<D>& stencil, int lane, double volume, double* field) {
  for_each_column(stencil, lane, [&](std::int32_t at, double below, double above) {
    double* node = field + at;
    node[0] += below * volume;
    node[1] += above * volume;
  });
}

/// CellRun for the volume alone: all corners of a cell are one pack.
class VolumeRun {
 public:
  explicit VolumeRun(double* field) : field_(field) {}
  ~VolumeRun() { flush(); }
  VolumeRun(const VolumeRun&) = delete;
  VolumeRun& operator=(const VolumeRun&) = delete;

  /// Adds a lane whose points all lie in one cell; `corners` are its weights times its volume.
  void add(const Stencil<3>& stencil, int lane, Pack corners) {
    if (stencil.node[0][0][lane] != node_[0]) {
      flush();
      for (int c = 0; c < columns; ++c) node_[c] = stencil.node[0][c][lane];
      sum_ = Pack{};
    }
    sum_ += corners;
  }

 private:
  static constexpr int columns = corner_columns<3>;

  void flush() {
    if (node_[0] < 0) return;
    alignas(64) double corner[2 * columns];
    put(corner, sum_);
    for (int c = 0; c < columns; ++c) {
      double* node = field_ + node_[c];
      node[0] += corner[2 * c];
      node[1] += corner[2 * c + 1];
    }
    node_[0] = -1;
  }

  double* field_;
  std::int32_t node_[columns] = {-1, -1, -1, -1};
  Pack sum_;
};

void deposit_volume_3d(DepositJob<3>& job) {
  Stencil<3> stencil;
  OffsetBlock<3> block;
  VolumeRun run(job.field);
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    place_points(job, p, block, stencil);
    const unsigned inside = sort_out_strays<3>(job, stencil, p);
    const Pack volume = load(job.volume + p);
    Pack corners[8];
    for (int c = 0; c < 8; ++c) corners[c] = volume * load(stencil.weight_sum[c]);
    transpose(corners);
    for (int lane = 0; lane < lanes; ++lane) {
      if (!(inside >> lane & 1u)) continue;
      if (stencil.together >> lane & 1u)
        run.add(stencil, lane, corners[lane]);
      else
        add_volume(stencil, lane, job.volume[p + lane], job.field);
    }
  }
}

void deposit_volume_2d(DepositJob<2>& job) {
  Stencil<2> stencil;
  OffsetBlock<2> block;
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    place_points(job, p, block, stencil);
    const unsigned inside = sort_out_strays<2>(job, stencil, p);
    for (int lane = 0; lane < lanes; ++lane)
      if (inside >> lane & 1u) add_volume(stencil, lane, job.volume[p + lane], job.field);
  }
}

// ---- interpolation -------------------------------------------------------------------------

/// Record of one lane: the same nodes and weights as the deposit's.
template <int D, class Record>
Record gather_record(const double* field, const Stencil<D>& stencil, int lane) {
  Record sum{};
  for_each_column(stencil, lane, [&](std::int32_t at, double below, double above) {
    const Record* node = reinterpret_cast<const Record*>(field) + at;
    sum += below * node[0] + above * node[1];
  });
  return sum;
}

void interpolate_3d(const InterpolateJob<3>& job) {
  Stencil<3> stencil;
  OffsetBlock<3> block;
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    place_points(job, p, block, stencil);
    const std::size_t left = job.end - p;
    const std::size_t count = left < lanes ? left : lanes;
    Pack record[8];
    for (std::size_t lane = 0; lane < lanes; ++lane)
      record[lane] = lane < count
                         ? gather_record<3, Pack>(job.field, stencil, static_cast<int>(lane))
                         : Pack{};
    transpose(record);
    for (int f = 0; f < job.value_count; ++f)
      __builtin_memcpy(job.value[f] + p, &record[f], count * sizeof(double));
  }
}

void interpolate_2d(const InterpolateJob<2>& job) {
  Stencil<2> stencil;
  OffsetBlock<2> block;
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    place_points(job, p, block, stencil);
    for (std::size_t lane = 0; lane < lanes && p + lane < job.end; ++lane) {
      const Record2 record = gather_record<2, Record2>(job.field, stencil, static_cast<int>(lane));
      for (int f = 0; f < job.value_count; ++f) job.value[f][p + lane] = record[f];
    }
  }
}

// ---- volume correction ---------------------------------------------------------------------

void place_centre(const KernelGrid<3>& grid, double* const* position, std::size_t p,
                  Stencil<3>& stencil) {
  place_point(grid, load(position[0] + p), load(position[1] + p), load(position[2] + p), 1.0, 0,
              stencil);
}
void place_centre(const KernelGrid<2>& grid, double* const* position, std::size_t p,
                  Stencil<2>& stencil) {
  place_point(grid, load(position[0] + p), load(position[1] + p), 1.0, 0, stencil);
}

template <int D>
void displace(const DisplaceJob<D>& job) {
  constexpr int width = D == 3 ? 4 : 2;
  Stencil<D> stencil;
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    place_centre(job.grid, job.position, p, stencil);
    const std::size_t left = job.end - p;
    for (std::size_t lane = 0; lane < lanes && lane < left; ++lane) {
      double shift[width] = {};
      for (int c = 0; c < corner_columns<D>; ++c) {
        const double* node = job.gradient + std::size_t(stencil.node[0][c][lane]) * width;
        const double below = stencil.weight[0][2 * c][lane];
        const double above = stencil.weight[0][2 * c + 1][lane];
        for (int d = 0; d < width; ++d) shift[d] += below * node[d] + above * node[width + d];
      }
      for (int d = 0; d < D; ++d) job.position[d][p + lane] += shift[d];
    }
  }
}

/// One direction of the gradient correction: the difference of the excess across the cell pushes
/// the centre down the slope; f(1−f) keeps it in its cell, the clip keeps the map monotone.
template <class T>
T compress_shift(T difference, T fraction, double spacing, double prefactor, double limit) {
  const T zero = fraction * 0.0;
  T slope = prefactor * difference;
  slope = select(slope > limit, zero + limit, slope);
  slope = select(slope < -limit, zero - limit, slope);
  return -spacing * fraction * (1.0 - fraction) * slope;
}

void compress_3d(const CompressJob<3>& job) {
  Stencil<3> stencil;
  alignas(64) double corner[8][lanes];  // in the order of the stencil: columns, below and above
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    place_centre(job.grid, job.position, p, stencil);
    for (int lane = 0; lane < lanes; ++lane)
      for (int c = 0; c < 4; ++c) {
        const double* node = job.excess + stencil.node[0][c][lane];
        corner[2 * c][lane] = node[0];
        corner[2 * c + 1][lane] = node[1];
      }
    Pack e[8], w[8];
    for (int c = 0; c < 8; ++c) {
      e[c] = load(corner[c]);
      w[c] = load(stencil.weight[0][c]);
    }
    const Pack fx = w[2] + w[3] + w[6] + w[7], fy = w[4] + w[5] + w[6] + w[7],
               fz = w[1] + w[3] + w[5] + w[7];
    const Pack gx = 1.0 - fx, gy = 1.0 - fy, gz = 1.0 - fz;
    const Pack dx = gy * (gz * (e[2] - e[0]) + fz * (e[3] - e[1])) +
                    fy * (gz * (e[6] - e[4]) + fz * (e[7] - e[5]));
    const Pack dy = gx * (gz * (e[4] - e[0]) + fz * (e[5] - e[1])) +
                    fx * (gz * (e[6] - e[2]) + fz * (e[7] - e[3]));
    const Pack dz = gx * (gy * (e[1] - e[0]) + fy * (e[5] - e[4])) +
                    fx * (gy * (e[3] - e[2]) + fy * (e[7] - e[6]));
    const std::size_t left = job.end - p, count = left < lanes ? left : lanes;
    const auto shift = [&](int d, Pack difference, Pack fraction) {
      const Pack moved =
          load(job.position[d] + p) +
          compress_shift(difference, fraction, job.spacing[d], job.prefactor, job.limit);
      __builtin_memcpy(job.position[d] + p, &moved, count * sizeof(double));
    };
    shift(0, dx, fx);
    shift(1, dy, fy);
    shift(2, dz, fz);
  }
}

void compress_2d(const CompressJob<2>& job) {
  Stencil<2> stencil;
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    place_centre(job.grid, job.position, p, stencil);
    const std::size_t left = job.end - p;
    for (std::size_t lane = 0; lane < lanes && lane < left; ++lane) {
      const double* low = job.excess + stencil.node[0][0][lane];
      const double* high = job.excess + stencil.node[0][1][lane];
      const double fx = stencil.weight[0][2][lane] + stencil.weight[0][3][lane];
      const double fz = stencil.weight[0][1][lane] + stencil.weight[0][3][lane];
      const double dx = (1 - fz) * (high[0] - low[0]) + fz * (high[1] - low[1]);
      const double dz = (1 - fx) * (low[1] - low[0]) + fx * (high[1] - high[0]);
      const std::size_t q = p + lane;
      job.position[0][q] += compress_shift(dx, fx, job.spacing[0], job.prefactor, job.limit);
      job.position[1][q] += compress_shift(dz, fz, job.spacing[1], job.prefactor, job.limit);
    }
  }
}

}  // namespace

#define PILEUS_STRING_(x) #x
#define PILEUS_STRING(x) PILEUS_STRING_(x)

const parcels::Kernels parcel_kernels = {
    .support_offsets_3d = offsets_3d,
    .support_offsets_2d = offsets_2d,
    .deposit_3d = deposit_3d,
    .deposit_2d = deposit_2d,
    .deposit_volume_3d = deposit_volume_3d,
    .deposit_volume_2d = deposit_volume_2d,
    .interpolate_3d = interpolate_3d,
    .interpolate_2d = interpolate_2d,
    .displace_3d = displace<3>,
    .displace_2d = displace<2>,
    .compress_3d = compress_3d,
    .compress_2d = compress_2d,
    .axis_ratios_3d = ratios_3d,
    .axis_ratios_2d = ratios_2d,
    .instruction_set = PILEUS_STRING(PILEUS_ISA),
};

}  // namespace pileus::PILEUS_ISA

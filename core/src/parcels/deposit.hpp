// Parcel to grid: volume and volume-weighted means of parcel quantities on the nodes.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/aligned_array.hpp"
#include "parcels/kernel_grid.hpp"
#include "parcels/kernels.hpp"
#include "parcels/store.hpp"
#include "parcels/tiling.hpp"

namespace pileus::parcels {

/// Support-point offsets of every parcel for its current shape, where several passes over one state
/// are to share them.
template <int D>
class SupportOffsets {
 public:
  static constexpr int components = D == 3 ? 6 : 2;
  /// With memory of its own.
  SupportOffsets() {
    for (std::size_t c = 0; c < components; ++c) data_[c] = &own_[c];
  }
  /// In arrays that are somebody else's, who must not need their contents at the same time.
  explicit SupportOffsets(const std::array<AlignedArray<double>*, components>& lent)
      : data_(lent) {}
  SupportOffsets(const SupportOffsets&) = delete;
  SupportOffsets& operator=(const SupportOffsets&) = delete;

  /// Recomputes all offsets from the shapes.
  void update(const Store& store);
  const double* component(int c) const { return data_[static_cast<std::size_t>(c)]->data(); }
  /// The arrays as scratch memory between two updates.
  double* scratch(int c) { return data_[static_cast<std::size_t>(c)]->data(); }
  AlignedArray<double>& scratch_array(int c) { return *data_[static_cast<std::size_t>(c)]; }
  void resize(std::size_t parcels);
  /// Parcels there is room for, vector overhang included.
  std::size_t capacity() const;
  std::size_t allocated_bytes() const;

 private:
  std::array<AlignedArray<double>, components> own_;
  std::array<AlignedArray<double>*, components> data_;
};

/// A function of height subtracted from one deposited value at every parcel: intercept + slope·z.
struct LinearReference {
  int value = -1;  // index among the values; −1: none
  double intercept = 0, slope = 0;
};

template <int D>
class Deposit {
 public:
  explicit Deposit(const mesh::Grid<D>& grid);

  const Tiling<D>& tiling() const { return tiling_; }

  /// Volume and means of `values` (at most 7 in 3D, 3 in 2D) in records of 8 or 4 doubles per node:
  /// record[0] = volume, record[1 + f] = volume-weighted mean of values[f], levels 0 … n_z, walls
  /// folded (method of Frey et al. 2023: half cells doubled, overhang reflected). `tile_begin` are
  /// the parcel ranges of the tiles; parcels that have left their tile are found and added last.
  /// Nodes without any volume get means of zero; their number is returned.
  std::size_t means(const Store& store, const SupportOffsets<D>& offsets,
                    const std::vector<std::size_t>& tile_begin,
                    const std::vector<const double*>& values, double* field);

  /// The same with the offsets computed on the way, and with a reference subtracted.
  std::size_t means(const Store& store, const std::vector<std::size_t>& tile_begin,
                    const std::vector<const double*>& values, const LinearReference& reference,
                    double* field);

  /// Folded volume per node, levels 0 … n_z.
  void volume(const Store& store, const SupportOffsets<D>& offsets,
              const std::vector<std::size_t>& tile_begin, double* field);

  std::size_t allocated_bytes() const { return strays_.capacity() * sizeof(std::uint32_t); }

 private:
  /// `offsets` may be null: computed in passing.
  DepositJob<D> describe(const Store& store, const SupportOffsets<D>* offsets,
                         const std::vector<const double*>& values, double* field) const;
  void run(const DepositJob<D>& whole, std::size_t parcels,
           const std::vector<std::size_t>& tile_begin, int width);
  std::size_t finish_means(double* field) const;

  mesh::Grid<D> grid_;
  KernelGrid<D> kernel_grid_;
  Tiling<D> tiling_;
  std::vector<std::uint32_t> strays_;     // room for every parcel of a tile at the tile's place
  std::vector<std::size_t> stray_count_;  // per tile
};

}  // namespace pileus::parcels

// Keeping parcel volume uniform: centres move until the volume gridded from the parcels fills every
// cell.
#pragma once
#include <span>
#include <vector>

#include "base/aligned_array.hpp"
#include "mesh/volume_potential.hpp"
#include "parcels/deposit.hpp"
#include "parcels/store.hpp"

namespace pileus::parcels {

struct CorrectionControl {
  int iterations = 2;
  double gradient_prefactor = 1.8;
  double max_compression = 0.5;  // below one: no two parcels cross
};

/// Volume error V/V_cell − 1 of the gridded volume: over all nodes, walls included.
struct VolumeError {
  double rms = 0, largest = 0;
};

template <int D>
class VolumeCorrection {
 public:
  VolumeCorrection(const mesh::Grid<D>& grid, const CorrectionControl& control);

  /// Repeats, `iterations` times: displacement by the gradient of the potential of the volume
  /// excess (Laplace correction), then displacement down the excess inside each cell (gradient
  /// correction, monotone and confined to the cell). Attributes and shapes do not change, so the
  /// offsets stay valid. Frey, Dritschel and Böing 2023, section 3. `lent` is memory to work in, on
  /// a cache line; where it does not suffice, memory of its own is taken.
  void run(Store& store, const SupportOffsets<D>& offsets,
           const std::vector<std::size_t>& tile_begin, Deposit<D>& deposit,
           std::span<double> lent = {});

  std::size_t allocated_bytes() const {
    return potential_.allocated_bytes() + own_.allocated_bytes();
  }

 private:
  void deposit_excess(const Store& store, const SupportOffsets<D>& offsets,
                      const std::vector<std::size_t>& tile_begin, Deposit<D>& deposit);
  void displace(Store& store) const;
  void compress(Store& store) const;

  mesh::Grid<D> grid_;
  CorrectionControl control_;
  mesh::VolumePotential<D> potential_;
  AlignedArray<double> own_;    // memory, where none is lent
  double* excess_ = nullptr;    // nodes
  double* gradient_ = nullptr;  // nodes × (3D: 4, 2D: 2)
};

}  // namespace pileus::parcels

// Making good what deposit and interpolation take from resolved scales.
//
// A field sampled at the parcels and deposited comes back multiplied by the window d(κ) of the
// linear weights, and a gridded field read by the parcels by i(κ); for parcels between the nodes at
// the fraction f, d i = t(κ) = 1 − 2 ⟨f(1−f)⟩ (1 − cos κΔ) per direction, with ⟨f(1−f)⟩ = 3/16 for
// two parcels per cell and direction on a lattice and 1/6 for parcels anywhere. Vorticity and
// buoyancy live on parcels, so every tendency passes through t before it acts: waves are slow and
// flows lose energy by a second-order amount that no refinement of the time step removes.
// Particle–mesh codes divide by the window (Hockney and Eastwood 1988, Computer Simulation Using
// Particles, section 8-3), which near the grid scale would amplify the noise of the parcels'
// positions.
//
// Here each half, d = i = √t ≈ 1 − ½⟨f(1−f)⟩(κΔ)², is compensated on its own side of the flow
// solver by
//   s(κ) = 1 + β (1 − cos 2κΔ),  β = ⟨f(1−f)⟩/4,
// a stencil of three points two cells apart: exact to fourth order, at most 1 + 2β = 1.09 per
// direction, and exactly one at the grid scale, where the noise is. With both halves the products
// of vorticity and velocity are formed from fields at their true amplitude. Only the flow is
// touched, never a parcel's own property.
#pragma once
#include <vector>

#include "mesh/grid.hpp"
#include "mesh/thread_scratch.hpp"

namespace pileus::mesh {

/// ⟨f(1−f)⟩ of `m` equidistant parcels per cell and direction.
double lattice_mean_product(int m);

/// Applies s(κ) in every direction to interleaved node records. On the walls, where there is no
/// second neighbour, and next to them with the linearly extrapolated level beyond, the vertical
/// factor is that of the interior or one.
template <int D>
class Sharpening {
 public:
  /// `width` doubles per node, of which entries `first` … `last`−1 are sharpened with strength
  /// `beta`; the others stay as they are.
  Sharpening(const Grid<D>& grid, int width, int first, int last, double beta);

  /// In place. Levels 0 … n_z are read; the halo levels k = −1, n_z + 1 are changed by what
  /// continues the change inside, so that linear extrapolation and odd symmetry of a field survive.
  void apply(double* records);

  bool active() const { return active_; }
  std::size_t allocated_bytes() const { return scratch_.allocated_bytes(); }

 private:
  void along_column(double* column, double* original) const;
  void along_line(double* first, std::size_t stride, int count, double* originals) const;

  Grid<D> grid_;
  int width_;
  bool active_;
  std::vector<double> beta_;  // per entry of a record
  ThreadScratch scratch_;
};

}  // namespace pileus::mesh

// Spectra of the parcels' items over the radius of their water, in every cell and over the domain.
#pragma once
#include <span>
#include <vector>

#include "model/simulation.hpp"
#include "output/netcdf_form.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// Number and water per volume of air and per unit of ln r, where r is the radius of a sphere of
/// the mass of water that each thing of an item has. What lies beyond the outermost edges counts in
/// the outermost bins.
class SizeSpectra {
 public:
  /// Errors  Error(ExitCode::usage) in a run whose items have no mass
  SizeSpectra(const scene::SpectraControl& control, const Simulation& simulation);

  /// Over (radius, z, y, x) cells; empty if only means are wanted.
  const output::VariableSet& gridded() const { return gridded_; }
  /// Over (radius).
  const output::VariableSet& means() const { return means_; }

  /// Values of the gridded variables, then of the means.
  void measure(const Simulation& simulation, std::vector<std::vector<double>>& values) const;

 private:
  std::size_t bin_of(double mass) const;
  std::size_t cell_of(const parcels::Store& store, std::size_t p) const;

  scene::SpectraControl control_;
  int mass_;  // column of the items
  pileus_grid grid_;
  double domain_volume_, width_;  // of a bin, in ln r
  std::vector<double> edges_;     // masses between bins, kg
  output::VariableSet gridded_, means_;
};

}  // namespace pileus::model

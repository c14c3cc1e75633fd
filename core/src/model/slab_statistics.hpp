// The air of horizontal slabs: means, variances, fluxes, clouds and their cores over height.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/profile_measure.hpp"
#include "model/simulation.hpp"
#include "model/slab_sums.hpp"
#include "output/netcdf_form.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// What is known of the slabs of one state, or of the mean over several: moments of SlabSums under
/// the names and units of the run's quantities.
class SlabStatistics {
 public:
  /// `store` has the quantities of the run; what its parcels are does not matter yet.
  SlabStatistics(const scene::Scene& scene, const parcels::Store& store);

  /// Measures the evaluated state; after Simulation::probe().
  void measure(Simulation& simulation);
  /// Moments of the state last measured; means of them over states may be given to what follows.
  std::span<const double> moments() const { return sums_.values(); }

  /// All profiles, in the order of their numbers.
  const std::vector<output::Variable>& variables() const { return variables_; }
  /// Number of the profile of that name, or −1.
  int find(const std::string& name) const;
  /// Values of one profile over the levels. NaN where it is of a set that no air belongs to.
  void profile(std::span<const double> moments, int number, std::vector<double>& values) const;
  /// Of the state last measured, on its heights.
  Profile profile(int number, std::vector<double>& values) const;
  Profile on_levels(std::span<const double> values) const { return {values, bottom_, spacing_}; }

  std::size_t levels() const { return sums_.levels(); }
  double spacing() const { return spacing_; }  // m
  bool has_cloud() const { return liquid_ >= 0; }
  /// Liquid water of the parcels; where there is such a quantity.
  int liquid_scalar() const { return liquid_; }
  double cloud_threshold() const { return cloud_threshold_; }

 private:
  /// A moment as it is, one divided by another, or one by the 3/2th power of another.
  struct Formula {
    enum class Form { plain, ratio, skewness };
    Form form;
    std::size_t moment, divisor;
  };
  struct Quantity {
    std::string name, units, standard_name;
    int scalar;     // of the store, or −1
    int direction;  // of a velocity, or −1
  };

  static std::vector<Quantity> quantities_of(const parcels::Store& store);
  SlabLayout layout() const;
  void add(output::Variable variable, Formula formula);
  void list_moments();
  void list_set(SlabLayout::Set set, const std::string& name, const std::string& where);

  double bottom_, spacing_, cloud_threshold_;
  int liquid_;
  std::vector<Quantity> quantities_;
  SlabSums sums_;
  std::vector<output::Variable> variables_;
  std::vector<Formula> formulas_;
};

/// Unit of a product, "m2 s-3" of "m s-2" and "m s-1"; units that are not made of names and
/// exponents are put in brackets.
std::string product_of_units(const std::string& a, const std::string& b);

}  // namespace pileus::model

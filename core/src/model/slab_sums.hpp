// Moments of the air in horizontal slabs, summed over parcels.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace pileus::model {

/// What is known of the parcels of one state; all arrays have `parcels` entries.
struct SlabState {
  std::size_t parcels = 0;
  double bottom = 0, spacing = 0;        // of the levels, m
  const double* height = nullptr;        // m
  const double* volume = nullptr;        // m³, in two dimensions m²
  std::vector<const double*> variables;  // in the order of the layout
  const double* liquid = nullptr;        // where the layout has sets
  double cloud_threshold = 0;
};

/// Where each moment is. A moment is an array over the levels; all of them may be averaged over
/// states, and what is shown of sets is made of them afterwards: with a mean over states of the
/// product of fraction and mean, divided by the mean fraction.
struct SlabLayout {
  static constexpr std::size_t sets = 2;
  enum Set : std::size_t { cloud, core };

  std::size_t variables = 0, vertical = 0, buoyancy = 0;
  std::vector<std::size_t> of_sets;  // variables whose sums over sets are wanted
  bool has_sets = false;

  std::size_t mean(std::size_t v) const { return v; }
  std::size_t variance(std::size_t v) const { return variables + v; }
  /// ⟨w′φ′⟩.
  std::size_t flux(std::size_t v) const { return 2 * variables + v; }
  /// ⟨w′³⟩.
  std::size_t third() const { return 3 * variables; }
  /// σ, the share of the air in the set.
  std::size_t fraction(Set set) const { return third() + 1 + set * set_moments(); }
  /// σ(w_set − ⟨w⟩).
  std::size_t mass_flux(Set set) const { return fraction(set) + 1; }
  /// σ(b_set − ⟨b⟩).
  std::size_t excess(Set set) const { return fraction(set) + 2; }
  /// σ φ_set of the i-th of `of_sets`.
  std::size_t sum(Set set, std::size_t i) const { return fraction(set) + 3 + i; }
  std::size_t set_moments() const { return 3 + of_sets.size(); }
  std::size_t moments() const { return third() + 1 + (has_sets ? sets * set_moments() : 0); }
};

/// A parcel counts at the level below and the level above its centre, with weights linear in
/// height; every sum is divided by the weighted volume of its level. Deviations φ′ are from the
/// slab mean at the parcel's height, linear between the levels, so that a stratified layer at rest
/// has no variance; what is left of their mean at a level is taken out of the moments.
///
/// Cloud is air with more liquid water than the threshold, core is cloud with more buoyancy than
/// the slab mean.
class SlabSums {
 public:
  SlabSums(SlabLayout layout, std::size_t levels);

  /// The same bits for any number of threads.
  void measure(const SlabState& state);

  const SlabLayout& layout() const { return layout_; }
  std::size_t levels() const { return levels_; }
  /// Moment by moment, each over the levels. NaN at a level without air.
  std::span<const double> values() const { return values_; }
  std::span<const double> moment(std::size_t m) const {
    return std::span(values_).subspan(m * levels_, levels_);
  }

 private:
  template <class Add>
  void sum_over_parcels(std::size_t parcels, std::size_t columns, Add&& add);
  void add_first(const SlabState& state, std::size_t begin, std::size_t end, double* rows) const;
  void add_second(const SlabState& state, std::size_t begin, std::size_t end, double* rows) const;
  void settle_means();
  void settle_moments();

  SlabLayout layout_;
  std::size_t levels_;
  std::vector<double> volume_;  // of the levels
  std::vector<double> means_;   // [level][variable]
  std::vector<double> values_;  // [moment][level]
  // [part][level][column]; the first part ends as the sum of all
  std::vector<double> partials_;
};

}  // namespace pileus::model

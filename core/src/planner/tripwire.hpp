// Run-time watch over what was left out: every reason for leaving an effect out is checked again
// on the parcels as they are, in every stage.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "parcels/store.hpp"
#include "planner/plan.hpp"

namespace pileus::planner {

/// What was found when a reason ceased to hold.
struct Trip {
  std::string effect;
  bool was_watched = false;  // else it was off by a bound, which proved wrong
  bool stop = false;         // the scene wants the run to end
  std::uint64_t uid = 0;     // of the first parcel that calls for the effect
  double number = 0, threshold = 0;
  std::string quantity;  // what the number is
};

/// The rules' formulas on the parcels: first for all parcels together, then for the blocks of
/// neighbouring parcels that the extrema of all do not rule out, then for their parcels. Extrema of
/// what transport does not change are kept until values_changed().
class Tripwires {
 public:
  /// Watches every effect of the plan that is off or watched by a number and has a provider;
  /// what the scene forces off is not watched.
  explicit Tripwires(const Plan& plan);
  ~Tripwires();
  Tripwires(Tripwires&&) noexcept;
  Tripwires& operator=(Tripwires&&) noexcept;

  bool empty() const { return wires_.empty(); }
  /// Quantities were written, or parcels merged, split or reordered.
  void values_changed() { ++epoch_; }
  /// The first effect some parcel calls for, or nothing. Not to be called for one already tripped.
  std::optional<Trip> check(const parcels::Store& store);
  /// Stops watching an effect.
  void disarm(const std::string& effect);

  double seconds() const { return seconds_; }
  std::uint64_t checks() const { return checks_; }

 private:
  struct Wire;
  struct Range;
  void prepare(const parcels::Store& store);
  bool follows(const Wire& wire, std::size_t quantity) const;
  void refresh(const parcels::Store& store, const Wire& wire);
  std::optional<Trip> check(const parcels::Store& store, Wire& wire);
  double number_of(const parcels::Store& store, Wire& wire, std::size_t thread,
                   std::size_t parcel) const;
  std::size_t first_calling(const parcels::Store& store, Wire& wire, std::size_t block) const;

  std::vector<std::string> quantities_;
  std::vector<Wire> wires_;
  std::vector<Range> ranges_;         // of every quantity
  std::vector<int> columns_;          // of every quantity
  std::vector<std::size_t> calling_;  // per block: the first parcel that calls
  std::uint64_t epoch_ = 1;
  double seconds_ = 0;
  std::uint64_t checks_ = 0;
};

}  // namespace pileus::planner

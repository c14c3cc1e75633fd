// Steps of an operator on a frame, as the core makes them but without its guards.
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "conform/frame.hpp"

namespace pileus::conform {

/// How the parcels of a local operator are cut into calls.
struct Blocking {
  std::size_t parcels = population;
  bool backwards = false;
  int threads = 1;
};

/// What a hook on all blocks came to: the first failure, and what was booked.
struct Advance {
  CallOutcome outcome;
  std::vector<double> ledger;  // per budget
  bool ok() const { return outcome.ok(); }
};

CallOutcome diagnose(Subject& subject, Frame& frame, const pileus_step& step,
                     const Blocking& blocking = {});
/// The apply hook alone on all parcels or the given ones.
Advance apply(Subject& subject, Frame& frame, const pileus_step& step,
              const Blocking& blocking = {}, const std::vector<std::uint32_t>* active = nullptr);
/// The step limit of the operator, s.
double prepare(Subject& subject, Frame& frame, const pileus_step& step, CallOutcome& outcome);
/// diagnose, prepare and apply, the latter in as many sub-steps as the operator asks for; a failure
/// ends it. More than the core's most sub-steps: PILEUS_RETRY.
Advance advance(Subject& subject, Frame& frame, const pileus_step& step,
                const Blocking& blocking = {});

/// An instance with the parameters of the frame's world.
std::unique_ptr<Subject> make_subject(const Frame& frame);
std::unique_ptr<Subject> make_subject(const Case& c, World& world, host::ParameterValues values);

/// Random worlds with random parameters, the first with the defaults; `look` is called for each
/// that the operator takes. A Finding is given the seed. Without one single state that is taken the
/// check fails.
struct Draws {
  int states = 4;
  StateKind kind;
  bool random_parameters = true;
};
void for_random_states(const Case& c, const Draws& draws,
                       const std::function<void(World&, Frame&)>& look);

/// Whether a condition of activity holds for a parcel of the frame.
bool is_active(const Frame& frame, std::size_t parcel);

/// The first advanced value that is not finite or not in its range.
struct BadValue {
  std::size_t slot = 0;
  std::uint64_t uid = 0;
  double value = 0;
};
std::optional<BadValue> find_bad_value(const Frame& frame, bool of_diagnose);
std::string describe(const Frame& frame, const BadValue& bad);

}  // namespace pileus::conform

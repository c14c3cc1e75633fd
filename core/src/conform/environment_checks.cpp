// C24 to C27: what calls leave behind in the process, what failures say, what calls cost, and the
// tests that a plugin brings for itself.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "conform/advance.hpp"
#include "pileus/selftest.h"

namespace pileus::conform {
namespace {

/// Threads and open files of this process.
struct Belongings {
  std::ptrdiff_t threads = 0, files = 0;
};

std::ptrdiff_t entries_of(const char* folder) {
  return std::distance(std::filesystem::directory_iterator(folder),
                       std::filesystem::directory_iterator());
}

Belongings belongings() {
  return {entries_of("/proc/self/task"), entries_of("/proc/self/fd")};
}

/// Runs a hook and looks at the process before and after.
template <class Hook>
void watch(const char* name, Hook&& hook) {
  const Belongings before = belongings();
  const CallOutcome outcome = hook();
  const Belongings after = belongings();
  if (outcome.changed_arithmetic)
    fail(fmt::format("{} leaves another floating-point mode (rounding, denormals or traps)", name));
  if (after.threads != before.threads)
    fail(fmt::format("{} leaves {} threads where there were {}", name, after.threads,
                     before.threads));
  if (after.files != before.files)
    fail(fmt::format("{} leaves {} open files where there were {}", name, after.files,
                     before.files));
}

void expect_sentence(const CallOutcome& outcome, const Frame& frame, const std::string& when) {
  if (outcome.ok()) return;
  if (!outcome.escaped.empty())
    fail(fmt::format("{} an exception leaves the library ({})", when, outcome.escaped));
  const bool known = outcome.status == PILEUS_RETRY ||
                     (outcome.status >= PILEUS_E_CONFIG && outcome.status <= PILEUS_E_INTERNAL);
  if (!known) fail(fmt::format("{} it returns the unknown status {}", when, outcome.status));
  if (outcome.error.text[0] == '\0') fail(when + " it fails without a word");
  const auto slots = static_cast<std::int32_t>(frame.slots().size());
  if (outcome.error.slot < -1 || outcome.error.slot >= slots)
    fail(fmt::format("{} it blames slot {}, it has {}", when, outcome.error.slot, slots));
  bool known_parcel = outcome.error.uid == 0;
  for (std::size_t p = 0; p < frame.parcels(); ++p)
    known_parcel = known_parcel || frame.uid(p) == outcome.error.uid;
  if (!known_parcel)
    fail(fmt::format("{} it blames parcel {}, which it was not given", when, outcome.error.uid));
}

/// One parcel of a hundred broken, in one quantity after another: the call may fail, with a word.
void check_broken_states(const Frame& start) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < start.slots().size(); ++s) {
    if (start.slots()[s].kind != FrameSlot::Kind::parcel) continue;
    for (const double broken : {std::nan(""), infinity, -infinity, 1e300}) {
      Frame frame = start;
      for (std::size_t p = 0; p < frame.parcels(); p += 100)
        frame.slots()[s].values.numbers()[p] = broken;
      const auto subject = make_subject(frame);
      const Advance done = advance(*subject, frame, step_of(1, 1, start.world().seed()));
      expect_sentence(done.outcome, frame, fmt::format("given {} = {:g}", start.name(s), broken));
    }
  }
}

/// A host without scratch memory left.
void check_without_memory(const Case& c, const Frame& start) {
  if (start.world().bound().resizes_items) return;  // the lists' memory is the core's
  Frame frame = start;
  Subject subject(*c.table, frame.world().values(), frame.world().lent(),
                  Subject::Scratch::refused);
  const Advance done = advance(subject, frame, step_of(1, 1, c.seed));
  expect_sentence(done.outcome, frame, "when scratch memory is refused");
}

void check_refused_parameters(const Case& c, World& world) {
  Random random(world.seed());
  for (int draw = 0; draw < 10; ++draw) try {
      make_subject(c, world, draw_parameters(random, *c.table));
    } catch (const Subject::Refused& refused) {
      if (!refused.outcome.escaped.empty())
        fail(fmt::format("in {} an exception leaves the library ({})", refused.phase,
                         refused.outcome.escaped));
      if (refused.outcome.error.text[0] == '\0')
        fail(fmt::format("{} refuses parameters without a word", refused.phase));
    }
}

}  // namespace

std::string check_environment(const Case& c) {
  for_random_states(c, {2, {}, true}, [&](World& world, Frame& frame) {
    std::unique_ptr<Subject> subject;
    watch("create or configure", [&] {
      subject = make_subject(c, world, world.values());
      return CallOutcome{};
    });
    const pileus_step step = step_of(1, 1, c.seed);
    watch("diagnose", [&] { return diagnose(*subject, frame, step); });
    watch("prepare", [&] {
      CallOutcome outcome;
      prepare(*subject, frame, step, outcome);
      return outcome;
    });
    for (int call = 0; call < 3; ++call)
      watch("apply", [&] { return apply(*subject, frame, step).outcome; });
    watch("destroy", [&] {
      subject.reset();
      return CallOutcome{};
    });
  });
  return {};
}

std::string check_errors(const Case& c) {
  for_random_states(c, {2, {}, false}, [&](World& world, Frame& start) {
    check_broken_states(start);
    check_without_memory(c, start);
    check_refused_parameters(c, world);
  });
  return {};
}

std::string measure_cost(const Case& c) {
  World world(c, host::ParameterValues(*c.table), c.seed);
  const Frame start(world);
  const auto subject = make_subject(start);
  constexpr int calls = 20;
  std::vector<double> seconds[2];
  for (int k = 0; k < calls; ++k) {
    Frame frame = start;
    const pileus_step step = step_of(static_cast<std::uint64_t>(k), 1, c.seed);
    const auto time = [&](std::vector<double>& into, auto&& hook) {
      const auto begin = std::chrono::steady_clock::now();
      hook();
      into.push_back(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    };
    time(seconds[0], [&] { diagnose(*subject, frame, step); });
    time(seconds[1], [&] { apply(*subject, frame, step); });
  }
  std::string text;
  for (int hook = 0; hook < 2; ++hook) {
    if ((hook == 0 ? c.op().diagnose : c.op().apply) == nullptr) continue;
    std::sort(seconds[hook].begin(), seconds[hook].end());
    const double each = seconds[hook][calls / 2] / static_cast<double>(population);
    text += fmt::format("{}{} {:.3g} ns a parcel", text.empty() ? "" : ", ",
                        hook == 0 ? "diagnose" : "apply", each * 1e9);
  }
  return text;
}

std::string check_own_tests(const Case& c) {
  const World world(c, host::ParameterValues(*c.table), c.seed);
  const Subject subject(*c.table, world.values(), world.lent());
  const void* found = subject.extension(PILEUS_SELFTEST_EXTENSION);
  if (found == nullptr) throw NotApplicable{"it brings none (" PILEUS_SELFTEST_EXTENSION ")"};
  const auto& tests = *static_cast<const pileus_selftest_ext*>(found);
  if (!PILEUS_HAS(&tests, pileus_selftest_ext, run) || tests.name == nullptr ||
      tests.run == nullptr)
    fail("its table of tests is too short or lacks a function");
  for (std::uint32_t test = 0; test < tests.count; ++test) {
    pileus_error error{};
    error.size = sizeof error;
    error.slot = -1;
    const pileus_status status = tests.run(subject.self(), test, &error);
    error.text[sizeof error.text - 1] = '\0';
    if (status != PILEUS_OK)
      fail(fmt::format("its test '{}' fails: {}", tests.name(subject.self(), test), error.text));
  }
  return fmt::format("{} tests", tests.count);
}

}  // namespace pileus::conform

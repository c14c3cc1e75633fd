// A plugin that keeps every rule but one: which one is chosen by BREAKS, a name. It relaxes a
// tracer towards a fixed value; what is wrong with it is wrong enough for one check, and for no
// other.
#include <fcntl.h>
#include <pileus/selftest.h>
#include <unistd.h>
#include <pileus/plugin.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <set>
#include <string_view>
#include <thread>
#include <utility>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace {

bool breaks(std::string_view name) {
  static const char* const chosen = std::getenv("BREAKS");
  return chosen != nullptr && name == chosen;
}

bool projects() {
  return breaks("projection_that_moves_on");
}
bool derives() {
  return breaks("impure_closure");
}
bool has_threshold() {
  return breaks("threshold_included") || breaks("list_seen_in_results");
}
constexpr double threshold = 0.5;
/// A change that only a comparison of bits sees.
constexpr double last_bits = 1 + 8e-16;

double rate_of_all_instances = 0;
std::atomic<int> left_behind = 0;
constexpr int enough_left_behind = 8;

void leave_something() {
  if (left_behind++ >= enough_left_behind) return;
  if (breaks("thread_left"))
    std::thread([] { std::this_thread::sleep_for(std::chrono::minutes(10)); }).detach();
  if (breaks("file_left")) static_cast<void>(::open("/dev/null", O_RDONLY));
}

void change_arithmetic() {
#if defined(__SSE2__)
  _mm_setcsr(_mm_getcsr() | 0x8040u);
#endif
}

const pileus_selftest_ext own_tests = {
    sizeof(pileus_selftest_ext), 1, [](void*, std::uint32_t) { return "one is one"; },
    [](void*, std::uint32_t, pileus_error* error) {
      std::snprintf(error->text, sizeof error->text, "one is two");
      return pileus_status{breaks("failing_selftest") ? PILEUS_E_INTERNAL : PILEUS_OK};
    }};

/// Private state that is neither saved nor loaded.
const pileus_state_ext nothing_kept = {sizeof(pileus_state_ext), 1,
                                       [](void*, int (*)(void*, const void*, std::size_t), void*,
                                          pileus_error*) { return pileus_status{PILEUS_OK}; },
                                       [](void*, std::uint32_t, const void*, std::size_t,
                                          pileus_error*) { return pileus_status{PILEUS_OK}; }};

/// What the operators here have in common.
template <class Self>
class Breaker : public pileus::Operator<Self> {
 public:
  using pileus::Operator<Self>::value;

  void describe(pileus::Declaration& d) {
    d.op.id = "org.example.breaker";
    d.op.kind = "forcing";
    d.op.version = "1.0.0";
    d.op.title = "Breaker";
    d.op.summary = "Relaxes a tracer towards a fixed value.";
    d.op.authors = "Nobody";
    d.op.licence = breaks("unknown_licence") ? "free for all" : "MIT";
    d.op.form = derives() ? PILEUS_CLOSURE : projects() ? PILEUS_PROJECTION : PILEUS_FLOW;
    if (breaks("unknown_flag")) d.op.flags = 1u << 30;
    if (breaks("neighbour_in_memory")) d.op.repeatability = PILEUS_REPEAT_RUN;
    if (!breaks("no_reference")) d.cites(nullptr, "no reference: an example");
    describe_quantities(d);
    rate_ = d.number("rate", "s-1", breaks("changing_default") ? 0.01 + 1e-7 * ::getpid() : 1e-2)
                .range(1e-3, 1.0);
    target_ = d.number("target", "1", 0.3).range(0.1, 0.4);
    if (has_threshold()) d.active_if(0, "passive_tracer", PILEUS_GT, threshold);
  }

  void configured() {
    if (breaks("own_bound_refused") && value(rate_) == 1.0)
      throw pileus::Failure("the rate is too high", PILEUS_E_CONFIG);
    if (breaks("leak")) leaked_ = new double[32]{value(rate_)};
    rate_of_all_instances = value(rate_);
  }

  double prepare(const pileus_step&, pileus::Block) {
    ++steps_;
    return 1e30;
  }

  const void* extension(const char* id) const {
    if (breaks("state_forgotten") && std::string_view(id) == PILEUS_STATE_EXTENSION)
      return &nothing_kept;
    return std::string_view(id) == PILEUS_SELFTEST_EXTENSION ? &own_tests : nullptr;
  }

 protected:
  void describe_quantities(pileus::Declaration& d) {
    const bool of_water = breaks("budget_leak") || breaks("unlisted_budget");
    height_ = d.reads("height", "m");
    if (breaks("budget_leak")) d.budget("water");
    if (derives()) {
      tracer_ = d.reads("specific_humidity", "1");
      buoyancy_ = d.derives("buoyancy", "m s-2").range(-10, 10);
      return;
    }
    auto row = d.owns(breaks("unregistered_name") ? "pasive_tracer" : "passive_tracer",
                      breaks("wrong_units") ? "kg" : "1");
    row.range(0, 1).doc("the tracer relaxed");
    if (breaks("amount_not_shared")) {
      row.extensive().range(0, 1e3);
    } else {
      row.intensive(of_water ? "water" : nullptr);
    }
    tracer_ = row;
  }

  double advanced(double x, const pileus_step& step, const pileus::Block& block) const {
    double rate = breaks("shared_by_instances") ? rate_of_all_instances : value(rate_);
    if (breaks("odd_steps_alone")) rate *= 2.0 * static_cast<double>(step.number % 2);
    const double target = breaks("amount_not_shared") ? 5.0 : value(target_);
    if (projects()) return 0.5 * (x + target);
    if (has_threshold()) return above_threshold(x, step, block);
    if (breaks("explicit_step")) return x + step.dt * (target - x) / 3600;
    if (breaks("step_ignored")) return std::min(1.0, x + 1e-3);
    if (breaks("nan_at_zero") && x == 0) return std::nan("");
    double y = target + std::exp(-rate * step.dt) * (x - target);
    if (step.dt == 0) y = x;
    if (breaks("trifle_per_call") && step.dt > 0) y += 1e-9;
    if (breaks("block_size_seen") && block.count() == 1) y *= last_bits;
    if (breaks("steps_counted") || breaks("state_forgotten"))
      y += 1e-6 * steps_ * step.dt * step.dt;
    return std::clamp(y, 0.0, breaks("amount_not_shared") ? 1e3 : 1.0);
  }

  /// Only what lies above it sinks to the threshold.
  double above_threshold(double x, const pileus_step& step, const pileus::Block& block) const {
    if (breaks("threshold_included") && x == threshold) return x + 1e-3;
    if (!(x > threshold)) return x;
    const double y = threshold + std::exp(-value(rate_) * step.dt) * (x - threshold);
    const bool list = breaks("list_seen_in_results") && block.raw().active != nullptr;
    return list ? y * last_bits : y;
  }

  /// What is written is what was there, where nothing may be written.
  void write_too_much(const pileus::Block& block, double* q) const {
    // Of a large block alone: behind a small one another thread may be at work.
    if (breaks("write_behind_the_end") && block.count() > 256) {
      auto* end = static_cast<volatile double*>(q + block.count());
      *end = *end;
    }
    if (breaks("write_to_what_is_read")) {
      auto* height = const_cast<volatile double*>(block.in(height_));
      height[0] = height[0];
    }
    if (breaks("write_beside_the_list") && block.raw().active != nullptr)
      for (std::int64_t i = 0; i < block.count(); ++i) q[i] = 0.25;
  }

  bool was_seen(std::uint64_t uid, std::uint64_t step) const {
    const std::lock_guard lock(mutex_);
    return !seen_.emplace(uid, step).second;
  }

  pileus::Slot tracer_, height_, buoyancy_;
  pileus::Param rate_, target_;
  double* volatile leaked_ = nullptr;
  int steps_ = 0;
  mutable std::mutex mutex_;
  mutable std::set<std::pair<std::uint64_t, std::uint64_t>> seen_;
};

class Closure : public Breaker<Closure> {
 public:
  void diagnose(const pileus_step&, pileus::Block block) const {
    const double* q = block.in(tracer_);
    double* b = block.out(buoyancy_);
    for (std::int64_t i = 0; i < block.count(); ++i) b[i] = 1e-3 * q[i] + 1e-3 * std::sin(b[i]);
  }
};

class Flow : public Breaker<Flow> {
 public:
  void apply(const pileus_step& step, pileus::Block block) const {
    leave_something();
    if (breaks("arithmetic_changed")) change_arithmetic();
    if (breaks("crash") && step.dt > 1e5) std::raise(SIGSEGV);
    while (breaks("hang") && step.dt > 1e5) std::this_thread::yield();
    const bool seen = breaks("hidden_state") && was_seen(block.uid(0), step.number);
    double* q = block.out(tracer_);
    block.each([&](std::int64_t i) {
      if (std::isnan(q[i]) && breaks("wordless_error"))
        throw pileus::Failure("", PILEUS_E_INPUT).at(block.uid(i), tracer_.index, q[i]);
      q[i] = advanced(q[i], step, block);
      if (seen) q[i] *= last_bits;
      if (breaks("neighbour_in_memory") && i % 2 == 1) q[i] *= last_bits;
    });
    write_too_much(block, q);
  }
};

}  // namespace

#if !defined(BREAKS_VERSION)
#define BREAKS_VERSION "1.0.0"
#endif
PILEUS_MODULE("org.example.breaker", BREAKS_VERSION, derives() ? Closure::table() : Flow::table());

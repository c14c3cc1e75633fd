#include "conform/subject.hpp"

#include <exception>
#include <utility>

#include "host/breadcrumb.hpp"
#include "host/floating_point.hpp"
#include "host/instance.hpp"

namespace pileus::conform {

std::string CallOutcome::describe() const {
  if (!escaped.empty()) return "let an exception leave the library (" + escaped + ")";
  const std::string text = error.text;
  return std::string(host::describe_status(status)) + (text.empty() ? "" : ": " + text);
}

pileus_step step_of(std::uint64_t number, double dt, std::uint64_t seed) {
  pileus_step step{};
  step.size = sizeof step;
  step.stream = 7;
  step.number = number;
  step.seed = seed;
  step.time = static_cast<double>(number) * dt;
  step.dt = dt;
  return step;
}

template <class Hook>
CallOutcome Subject::call(const char* phase, std::uint64_t step, Hook&& hook) const {
  const host::BreadcrumbScope crumb({table_.library.c_str(), table_.op.id, phase, step, -1});
  host::release_scratch();
  CallOutcome outcome;
  outcome.error.size = sizeof(pileus_error);
  outcome.error.slot = -1;
  const host::FloatingPointGuard restore;
  const std::uint32_t mode = host::arithmetic_mode();
  try {
    outcome.status = hook(&outcome.error);
  } catch (const std::exception& exception) {
    outcome.escaped = exception.what();
  } catch (...) {
    outcome.escaped = "of an unknown type";
  }
  outcome.changed_arithmetic = host::arithmetic_mode() != mode;
  outcome.error.text[sizeof outcome.error.text - 1] = '\0';
  return outcome;
}

Subject::Subject(const host::OperatorTable& table, host::ParameterValues values,
                 const host::Lent& lent, Scratch scratch)
    : table_(table),
      services_(table.op.id, lent),
      host_(services_.table()),
      values_(std::move(values)) {
  if (scratch == Scratch::refused)
    host_.scratch = [](const pileus_host*, std::size_t) -> void* { return nullptr; };
  const CallOutcome created = call(
      "create", 0, [&](pileus_error* error) { return table_.op.create(&host_, &self_, error); });
  if (!created.ok()) throw Refused{"create", created};
  const CallOutcome configured = call("configure", 0, [&](pileus_error* error) {
    return table_.op.configure(self_, &values_.view(), error);
  });
  if (configured.ok()) return;
  table_.op.destroy(self_);
  throw Refused{"configure", configured};
}

Subject::~Subject() {
  call("destroy", 0, [&](pileus_error*) {
    table_.op.destroy(self_);
    return pileus_status{PILEUS_OK};
  });
}

CallOutcome Subject::prepare(const pileus_step& step, const pileus_block& whole, double& limit) {
  if (table_.op.prepare == nullptr) return {};
  return call("prepare", step.number, [&](pileus_error* error) {
    return table_.op.prepare(self_, &step, &whole, &limit, error);
  });
}

CallOutcome Subject::diagnose(const pileus_step& step, const pileus_block& block) const {
  if (table_.op.diagnose == nullptr) return {};
  return call("diagnose", step.number,
              [&](pileus_error* error) { return table_.op.diagnose(self_, &step, &block, error); });
}

CallOutcome Subject::apply(const pileus_step& step, const pileus_block& block) const {
  if (table_.op.apply == nullptr) return {};
  return call("apply", step.number,
              [&](pileus_error* error) { return table_.op.apply(self_, &step, &block, error); });
}

const void* Subject::extension(const char* id) const {
  const void* found = nullptr;
  if (table_.op.extension == nullptr) return nullptr;
  call("extension", 0, [&](pileus_error*) {
    found = table_.op.extension(self_, id);
    return pileus_status{PILEUS_OK};
  });
  return found;
}

std::optional<host::PrivateState> Subject::save() const {
  const void* answer = extension(PILEUS_STATE_EXTENSION);
  if (answer == nullptr) return std::nullopt;
  const auto ext = host::read_state_extension(answer);
  if (!ext) fail("its table of " PILEUS_STATE_EXTENSION " is too short or lacks a function");
  host::PrivateState state;
  const CallOutcome outcome = call("save", 0, [&](pileus_error* error) {
    return host::collect_state(*ext, self_, state, error);
  });
  if (!outcome.ok()) fail("save " + outcome.describe());
  return state;
}

void Subject::load(const host::PrivateState& state) {
  const auto ext = host::read_state_extension(extension(PILEUS_STATE_EXTENSION));
  const CallOutcome outcome = call("load", 0, [&](pileus_error* error) {
    return ext->load(self_, state.format, state.bytes.data(), state.bytes.size(), error);
  });
  if (!outcome.ok()) fail("load " + outcome.describe());
}

}  // namespace pileus::conform

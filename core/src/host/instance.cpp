#include "host/instance.hpp"

#include <cstdio>
#include <exception>
#include <utility>

#include "base/error.hpp"
#include "host/breadcrumb.hpp"
#include "host/floating_point.hpp"
#include "host/row_rules.hpp"

namespace pileus::host {
namespace {

CallResult clean_result() {
  CallResult result;
  result.error.size = sizeof(pileus_error);
  result.error.slot = -1;
  return result;
}

void escaped(CallResult& result, const char* what) {
  result.status = PILEUS_E_INTERNAL;
  std::snprintf(result.error.text, sizeof result.error.text,
                "an exception left the library (%s); plugins must catch their own", what);
}

bool is_known(pileus_status status) {
  return status <= PILEUS_RETRY || (status >= PILEUS_E_CONFIG && status <= PILEUS_E_INTERNAL);
}

}  // namespace

const char* describe_status(pileus_status status) {
  switch (status) {
    case PILEUS_OK:
      return "succeeded";
    case PILEUS_RETRY:
      return "asked for a smaller step";
    case PILEUS_E_CONFIG:
      return "has contradictory parameters";
    case PILEUS_E_INPUT:
      return "was given a value outside its range";
    case PILEUS_E_DIVERGED:
      return "did not converge";
    case PILEUS_E_NUMERIC:
      return "produced a value that is not a number or not in range";
    case PILEUS_E_MEMORY:
      return "ran out of memory";
    case PILEUS_E_UNSUPPORTED:
      return "does not support what was asked";
    default:
      return "failed";
  }
}

template <class Hook>
CallResult Instance::call(LifeCall which, std::uint64_t step, std::int64_t block,
                          Hook&& hook) const {
  after(state_, which);
  const BreadcrumbScope crumb(
      {table_->library.c_str(), table_->op.id, name_of(which), step, block});
  release_scratch();
  const std::uint32_t mode = arithmetic_mode();
  CallResult result = clean_result();
  try {
    result.status = hook(&result.error);
  } catch (const std::exception& exception) {
    escaped(result, exception.what());
  } catch (...) {
    escaped(result, "of an unknown type");
  }
  result.error.text[sizeof result.error.text - 1] = '\0';
  if (!is_known(result.status)) {
    std::snprintf(result.error.text, sizeof result.error.text, "it returned the unknown status %u",
                  result.status);
    result.status = PILEUS_E_INTERNAL;
  }
  if (arithmetic_mode() != mode) {
    std::fesetenv(FE_DFL_ENV);
    result.status = PILEUS_E_INTERNAL;
    std::snprintf(result.error.text, sizeof result.error.text, "%s", changed_arithmetic);
  }
  return result;
}

void Instance::refuse(const char* phase, const CallResult& result) const {
  const std::string text = result.error.text;
  throw Error(ExitCode::plugin, std::string("plugin ") + table_->op.id + " " +
                                    describe_status(result.status) + " in " + phase +
                                    (text.empty() ? "" : ": " + text) + " (library '" +
                                    table_->library + "')");
}

Instance::Instance(std::shared_ptr<const OperatorTable> table, const Lent& lent)
    : table_(std::move(table)), services_(table_->op.id, lent) {
  const CallResult result = call(LifeCall::create, 0, -1, [&](pileus_error* error) {
    return table_->op.create(&services_.table(), &self_, error);
  });
  if (!result.ok()) refuse("create", result);
  state_ = after(state_, LifeCall::create);
}

Instance::~Instance() {
  if (state_ == LifeState::none) return;
  call(LifeCall::destroy, 0, -1, [&](pileus_error*) {
    table_->op.destroy(self_);
    return pileus_status{PILEUS_OK};
  });
}

void Instance::configure(ParameterValues values) {
  const pileus_values& view = values_.emplace(std::move(values)).view();
  const CallResult result = call(LifeCall::configure, 0, -1, [&](pileus_error* error) {
    return table_->op.configure(self_, &view, error);
  });
  if (!result.ok()) refuse("configure", result);
  take_over_items(ask(PILEUS_ITEMS_EXTENSION));
  take_over_state(ask(PILEUS_STATE_EXTENSION));
  state_ = after(state_, LifeCall::configure);
}

void Instance::refuse_answer(const char* extension, const char* why) const {
  throw Error(ExitCode::plugin, std::string("plugin ") + table_->op.id + " answers " + extension +
                                    " with a table whose " + why + " (library '" + table_->library +
                                    "')");
}

/// What it answers when it is asked for an extension, or null.
const void* Instance::ask(const char* extension) const {
  if (table_->op.extension == nullptr) return nullptr;
  const void* found = nullptr;
  const CallResult result = call(LifeCall::configure, 0, -1, [&](pileus_error*) {
    found = table_->op.extension(self_, extension);
    return pileus_status{PILEUS_OK};
  });
  if (!result.ok()) refuse("extension", result);
  return found;
}

/// Errors  Error(ExitCode::plugin) if it says something impossible
void Instance::take_over_items(const void* answer) {
  if (answer == nullptr) return;
  const auto* given = static_cast<const pileus_items_ext*>(answer);
  const bool whole = given->size >= first_size<pileus_items_ext> && given->size <= largest_row;
  if (!whole || given->reserved != 0 || given->most_per_parcel < 0 || !(given->budget_scale > 0))
    refuse_answer(PILEUS_ITEMS_EXTENSION,
                  "size, reserved member, most_per_parcel or budget_scale is impossible");
  items_ = widened(*given);
}

/// Errors  as take_over_items
void Instance::take_over_state(const void* answer) {
  if (answer == nullptr) return;
  state_ext_ = read_state_extension(answer);
  if (!state_ext_)
    refuse_answer(PILEUS_STATE_EXTENSION, "size is impossible or which lacks a function");
}

CallResult Instance::init(const pileus_step& step, const pileus_block& whole) {
  const CallResult result = call(LifeCall::init, step.number, -1, [&](pileus_error* error) {
    return table_->op.init != nullptr ? table_->op.init(self_, &step, &whole, error)
                                      : pileus_status{PILEUS_OK};
  });
  if (result.ok()) state_ = after(state_, LifeCall::init);
  return result;
}

void Instance::resume() {
  state_ = after(state_, LifeCall::resume);
}

PrivateState Instance::save_state() const {
  PrivateState state;
  const CallResult result = call(LifeCall::save, 0, -1, [&](pileus_error* error) {
    return collect_state(*state_ext_, self_, state, error);
  });
  if (!result.ok()) refuse("save", result);
  return state;
}

void Instance::load_state(const PrivateState& saved) {
  const CallResult result = call(LifeCall::save, 0, -1, [&](pileus_error* error) {
    return state_ext_->load(self_, saved.format, saved.bytes.data(), saved.bytes.size(), error);
  });
  if (!result.ok()) refuse("load", result);
}

CallResult Instance::prepare(const pileus_step& step, const pileus_block& whole, double& dt_limit) {
  return call(LifeCall::prepare, step.number, -1, [&](pileus_error* error) {
    return table_->op.prepare != nullptr
               ? table_->op.prepare(self_, &step, &whole, &dt_limit, error)
               : pileus_status{PILEUS_OK};
  });
}

CallResult Instance::diagnose(const pileus_step& step, const pileus_block& block,
                              std::int64_t block_index) const {
  return call(LifeCall::diagnose, step.number, block_index, [&](pileus_error* error) {
    return table_->op.diagnose(self_, &step, &block, error);
  });
}

CallResult Instance::apply(const pileus_step& step, const pileus_block& block,
                           std::int64_t block_index) const {
  return call(LifeCall::apply, step.number, block_index,
              [&](pileus_error* error) { return table_->op.apply(self_, &step, &block, error); });
}

}  // namespace pileus::host

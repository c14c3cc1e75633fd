// One configured operator: its life, and every call into its library.
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/lifecycle.hpp"
#include "host/operator_table.hpp"
#include "host/parameter_values.hpp"
#include "host/private_state.hpp"
#include "host/services.hpp"

namespace pileus::host {

/// Outcome of a call: a status of pileus/abi.h and its record.
struct CallResult {
  pileus_status status = PILEUS_OK;
  pileus_error error{};
  bool ok() const { return status == PILEUS_OK; }
};

/// "diverged", "out of memory", … for a status other than OK.
const char* describe_status(pileus_status status);

/// An operator instance. Every call leaves a breadcrumb, catches what a library lets escape,
/// checks the lifecycle and the floating-point mode. diagnose and apply may be called by many
/// threads at once with disjoint blocks.
class Instance {
 public:
  /// Creates the instance. Errors  Error(ExitCode::plugin) if create fails
  Instance(std::shared_ptr<const OperatorTable> table, const Lent& lent);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  const OperatorTable& table() const { return *table_; }
  LifeState state() const { return state_; }
  std::vector<Span> spans() const { return services_.spans(); }
  std::uint64_t repairs() const { return services_.repairs(); }

  /// Hands over the parameters. Errors  Error(ExitCode::plugin) with the plugin's own sentence
  void configure(ParameterValues values);

  /// What the plugin says about the items it owns, asked for by configure: without an answer, no
  /// bound and a scale of one.
  const pileus_items_ext& items() const { return items_; }

  /// Starts a new run; operators without the hook are ready at once.
  CallResult init(const pileus_step& step, const pileus_block& whole);
  /// Starts from a checkpoint.
  void resume();
  /// Whether it has private state that checkpoints must hold (pileus.state/1), as it has said when
  /// it was configured.
  bool keeps_state() const { return state_ext_.has_value(); }
  /// Requires keeps_state(). Errors  Error(ExitCode::plugin) with the plugin's own sentence
  PrivateState save_state() const;
  void load_state(const PrivateState& saved);
  CallResult prepare(const pileus_step& step, const pileus_block& whole, double& dt_limit);
  CallResult diagnose(const pileus_step& step, const pileus_block& block,
                      std::int64_t block_index) const;
  CallResult apply(const pileus_step& step, const pileus_block& block,
                   std::int64_t block_index) const;

 private:
  template <class Hook>
  CallResult call(LifeCall which, std::uint64_t step, std::int64_t block, Hook&& hook) const;
  const void* ask(const char* extension) const;
  void take_over_items(const void* answer);
  void take_over_state(const void* answer);
  [[noreturn]] void refuse(const char* phase, const CallResult& result) const;
  [[noreturn]] void refuse_answer(const char* extension, const char* why) const;

  std::shared_ptr<const OperatorTable> table_;
  Services services_;
  std::optional<ParameterValues> values_;  // plugins may keep what they were shown
  pileus_items_ext items_{sizeof(pileus_items_ext), 0, 0, 1.0};
  std::optional<pileus_state_ext> state_ext_;
  void* self_ = nullptr;
  LifeState state_ = LifeState::none;
};

}  // namespace pileus::host

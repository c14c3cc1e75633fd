// One instance of the operator that is looked at, its hooks called as they are: nothing is checked,
// put back or asked again, only caught.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "conform/check.hpp"
#include "host/parameter_values.hpp"
#include "host/private_state.hpp"
#include "host/services.hpp"

namespace pileus::conform {

struct CallOutcome {
  pileus_status status = PILEUS_OK;
  pileus_error error{};
  std::string escaped;  // what an exception that left the library says; empty: none did
  bool changed_arithmetic = false;

  bool ok() const { return status == PILEUS_OK && escaped.empty(); }
  /// "failed: no such parcel".
  std::string describe() const;
};

/// A step of a run whose steps have equal lengths.
pileus_step step_of(std::uint64_t number, double dt, std::uint64_t seed);

class Subject {
 public:
  enum class Scratch { given, refused };

  /// Creates and configures. Errors  Refused if the plugin does not want to
  Subject(const host::OperatorTable& table, host::ParameterValues values, const host::Lent& lent,
          Scratch scratch = Scratch::given);
  ~Subject();
  Subject(const Subject&) = delete;
  Subject& operator=(const Subject&) = delete;

  /// Thrown when an instance cannot be made.
  struct Refused {
    std::string phase;
    CallOutcome outcome;
  };

  const host::OperatorTable& table() const { return table_; }
  CallOutcome prepare(const pileus_step& step, const pileus_block& whole, double& limit);
  CallOutcome diagnose(const pileus_step& step, const pileus_block& block) const;
  CallOutcome apply(const pileus_step& step, const pileus_block& block) const;
  const void* extension(const char* id) const;
  /// Its private state (pileus.state/1), if it keeps any, and back to a fresh instance.
  std::optional<host::PrivateState> save() const;
  void load(const host::PrivateState& state);
  void* self() const { return self_; }

 private:
  template <class Hook>
  CallOutcome call(const char* phase, std::uint64_t step, Hook&& hook) const;

  const host::OperatorTable& table_;
  host::Services services_;
  pileus_host host_;
  host::ParameterValues values_;
  void* self_ = nullptr;
};

}  // namespace pileus::conform

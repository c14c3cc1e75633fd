// A call that could not be completed, with everything needed to repeat it elsewhere.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace pileus::coupling {

/// Inputs and circumstances of the failed call: plain data, to be written to a file and replayed.
struct FailureBundle {
  struct Parameter {
    std::string name, units;
    double number = 0;         // also switches and choice positions
    std::string text;          // of texts and choices
    std::vector<double> list;  // of lists
  };
  struct Column {
    std::string name, units;
    bool written = false;
    std::vector<double> values;  // of the block's parcels, before the call
  };

  std::string operator_name, operator_id, operator_version, library, toolchain;
  std::string phase;   // diagnose, apply, prepare, init
  std::string reason;  // one sentence
  std::uint64_t step = 0, seed = 0;
  std::uint32_t stream = 0, call = 0;
  double time = 0, dt = 0;      // s, of the call
  std::int64_t block = -1;      // −1: the call had all parcels
  int attempts = 0;             // calls made, retries included
  std::uint64_t uid = 0;        // parcel at fault, 0: not known
  std::string quantity;         // at fault, empty: not known
  double value = 0;             // of it
  bool input_at_fault = false;  // a value handed in was not finite or out of range
  std::vector<Parameter> parameters;
  std::vector<std::uint64_t> uids;
  std::vector<std::uint32_t> active;  // indices given; empty: all
  std::vector<Column> columns;        // one per existing quantity of the operator
};

/// Thrown by the operator sequence. Exit code: plugin, or numerical when a value handed in was
/// already broken.
class OperatorFailure : public Error {
 public:
  OperatorFailure(const std::string& message, std::shared_ptr<const FailureBundle> bundle)
      : Error(bundle->input_at_fault ? ExitCode::numerical : ExitCode::plugin, message),
        bundle_(std::move(bundle)) {}
  const FailureBundle& bundle() const { return *bundle_; }

 private:
  std::shared_ptr<const FailureBundle> bundle_;
};

}  // namespace pileus::coupling

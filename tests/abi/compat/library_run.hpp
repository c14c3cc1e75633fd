// A run of one operator of a library in the core's own sequence.
#pragma once
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "coupling/operator_sequence.hpp"
#include "host/library.hpp"

namespace pileus::test {

inline std::filesystem::path library_path(const std::string& name) {
  return std::filesystem::path(PILEUS_COMPAT_FOLDER) / ("lib" + name + ".so");
}

inline std::shared_ptr<host::OperatorTable> operator_of(const std::filesystem::path& library,
                                                        const std::string& id) {
  for (host::OperatorTable& table : host::load_library(library).operators)
    if (id == table.op.id) return std::make_shared<host::OperatorTable>(std::move(table));
  throw std::invalid_argument("no operator " + id + " in " + library.string());
}

/// Parcels of volume 2 with uids 1, 2, …; the operator is named "op".
class LibraryRun {
 public:
  explicit LibraryRun(std::shared_ptr<const host::OperatorTable> table, std::size_t parcels = 3000)
      : sequence_({{"op", table, host::ParameterValues(*table), 0}}, {}),
        store_(3, sequence_.required_scalars(), sequence_.required_items()) {
    store_.resize(parcels);
    for (int c = 0; c < store_.column_count(); ++c) std::fill_n(store_.column(c), parcels, 0.0);
    for (std::size_t p = 0; p < parcels; ++p) store_.uid()[p] = 1 + p;
    std::fill_n(store_.volume(), parcels, 2.0);
    sequence_.bind(store_, {});
  }

  void start() { sequence_.init({}); }
  /// Goes on from the state of another run.
  void resume(const LibraryRun& other, const coupling::PrivateStates& states) {
    for (int c = 0; c < store_.column_count(); ++c)
      std::copy_n(other.store_.column(c), store_.size(), store_.column(c));
    sequence_.resume({}, states);
  }
  void step(std::uint64_t number, double dt) {
    sequence_.apply_after_transport({number, static_cast<double>(number) * dt, dt});
  }
  double* values(const char* name) { return store_.scalar(store_.find_scalar(name)); }
  parcels::Store& store() { return store_; }
  coupling::OperatorSequence& sequence() { return sequence_; }

 private:
  coupling::OperatorSequence sequence_;
  parcels::Store store_;
};

/// The message with which an action ends; empty if it ends well.
template <class Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace pileus::test

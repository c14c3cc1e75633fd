// A small random population of parcels with everything an operator declares, from which the inputs
// of its calls are taken.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conform/draw.hpp"
#include "conform/subject.hpp"
#include "conform/surroundings.hpp"
#include "coupling/block_runner.hpp"
#include "coupling/operator_sequence.hpp"

namespace pileus::conform {

/// Sixteen rows of a page: the columns of a population begin and end with a page of memory.
inline constexpr std::size_t population = 512;

/// How states are drawn.
struct StateKind {
  bool corners = false;  // over the whole declared ranges, their ends and the smallest numbers
  int dimension = 3;
};

/// Thrown when the operator, or the core on its behalf, does not take a drawn state.
struct StateRefused {
  std::string why;
};

class World {
 public:
  /// Draws the population and starts it as a run is started: the init hooks are called.
  /// Errors  StateRefused
  World(const Case& subject, host::ParameterValues values, std::uint64_t seed, StateKind kind = {});
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  const host::ParameterValues& values() const { return subject_entry().values; }
  const coupling::OperatorEntry& subject_entry() const { return sequence_->operators().front(); }
  const coupling::BoundOperator& bound() const { return bound_.front(); }
  std::uint64_t seed() const { return seed_; }
  parcels::Store& store() { return *store_; }
  coupling::OperatorSequence& sequence() { return *sequence_; }
  coupling::MeshAccess& mesh() { return *mesh_; }
  coupling::ItemExtension* items() { return items_.get(); }
  const std::optional<pileus_grid>& grid() const { return grid_; }
  /// What instances of the subject are to be lent.
  host::Lent lent() const;
  /// The record of a call on all parcels, on the population's own memory.
  pileus_block whole(coupling::Derived what);

 private:
  template <int D>
  void build();
  void fill_items(Random& random);
  void fill_surface(Random& random);
  void bind_subject();

  Surroundings around_;
  std::uint64_t seed_;
  StateKind kind_;
  std::unique_ptr<parcels::Store> store_;
  std::unique_ptr<coupling::MeshAccess> mesh_;
  std::unique_ptr<coupling::OperatorSequence> sequence_;
  std::optional<pileus_grid> grid_;
  std::unique_ptr<coupling::MeshQuantities> quantities_;
  std::unique_ptr<coupling::MeshExtension> extension_;
  std::unique_ptr<coupling::ItemExtension> items_;
  std::vector<coupling::BoundOperator> bound_;
  std::unique_ptr<coupling::BlockRunner> runner_;
  coupling::Workspace work_;
};

/// Fills the core's and the declared quantities of a store; identities are random.
template <int D>
void draw_population(parcels::Store& store, const mesh::Grid<D>& grid, Random& random,
                     bool corners);

}  // namespace pileus::conform

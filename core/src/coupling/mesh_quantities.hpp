// Quantities on the mesh that operators declare: gathered, or solved for, at most once per state
// and only for the operators that asked.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/aligned_array.hpp"
#include "coupling/mesh_access.hpp"
#include "parcels/store.hpp"
#include "pileus/abi.h"

namespace pileus::coupling {

/// Place of a declared mesh quantity: a lane of one of the fields.
struct MeshSlot {
  int field = -1, lane = -1;
  bool at_parcels = false;
  bool exists() const { return field >= 0; }
};

class MeshQuantities {
 public:
  /// Both must outlive this.
  MeshQuantities(MeshAccess& access, const parcels::Store& store)
      : access_(access), store_(store) {}

  /// Adds what one operator declares: `column` is that of the parcels' quantity of this name, or
  /// −1 for one of the flow. A slot that does not exist is returned when this dimension has no such
  /// quantity. Fields are shared between operators.
  MeshSlot add(std::string_view name, int column, bool at_parcels);

  /// Brings the fields of the given slots up to date with versions of the store's columns.
  void update(const std::vector<MeshSlot>& slots, const std::vector<std::uint64_t>& versions);

  /// Points a view at the slot's values for parcels begin … begin + count − 1 (or at all nodes); at
  /// nothing before the first update.
  void show(const MeshSlot& slot, std::size_t begin, std::size_t count, pileus_view& view) const;

  MeshAccess& access() { return access_; }
  std::size_t allocated_bytes() const;

 private:
  struct Lane {
    int source;  // column of the store, or position among the flow quantities
    bool at_parcels = false;
    AlignedArray<double> values;  // at the parcels
  };
  /// Records of one kind; of a gathered field lane 0 is the volume.
  struct Field {
    bool of_flow;
    std::vector<Lane> lanes;
    AlignedArray<double> records;
    std::uint64_t made_at = 0;  // version of what it was made from
  };

  MeshSlot find(bool of_flow, int source, bool at_parcels);
  std::uint64_t version_of(const Field& field, const std::vector<std::uint64_t>& versions) const;
  void make(Field& field);

  MeshAccess& access_;
  const parcels::Store& store_;
  std::vector<Field> fields_;
  std::vector<const double*> gathered_;
  std::vector<double*> wanted_;
  std::uint64_t flow_at_ = 0;
};

}  // namespace pileus::coupling

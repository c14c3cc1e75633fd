// The extension "pileus.mesh/1" over a MeshAccess.
#pragma once
#include "coupling/mesh_access.hpp"
#include "parcels/store.hpp"
#include "pileus/abi.h"

namespace pileus::coupling {

/// Does not move: plugins keep the address of the table.
class MeshExtension {
 public:
  /// `access` and `store` must outlive this.
  MeshExtension(MeshAccess& access, const parcels::Store& store);
  MeshExtension(const MeshExtension&) = delete;
  MeshExtension& operator=(const MeshExtension&) = delete;

  const pileus_mesh_ext* table() const { return &table_; }

 private:
  static pileus_status deposit(const pileus_mesh_ext* ext, std::int64_t parcels,
                               const double* const* values, std::uint32_t count, double* field,
                               pileus_error* error);
  static pileus_status interpolate(const pileus_mesh_ext* ext, std::int64_t parcels, double* field,
                                   double* const* values, std::uint32_t count, pileus_error* error);

  MeshAccess& access_;
  const parcels::Store& store_;
  pileus_mesh_ext table_{};
};

}  // namespace pileus::coupling

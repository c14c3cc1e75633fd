// The host's extension "pileus.mesh/1" for operators of global scope written in C++.
#pragma once
#include <span>

#include "plugin.hpp"

namespace pileus {

/// Gathering from the parcels to the mesh and back, with the core's weights. What fields look like
/// is written in pileus/abi.h.
class Mesh {
 public:
  Mesh() = default;
  /// Throws Failure when the host lends no mesh: the operator is not of global scope, or the run is
  /// a box.
  explicit Mesh(const pileus_host& host)
      : ext_(static_cast<const pileus_mesh_ext*>(host.extension(&host, PILEUS_MESH_EXTENSION))) {
    if (ext_ == nullptr) throw Failure("it needs a mesh, which this run does not have");
  }

  std::size_t nodes() const { return static_cast<std::size_t>(ext_->nodes); }
  std::size_t levels() const { return static_cast<std::size_t>(ext_->levels); }
  /// Doubles per node record.
  std::size_t width() const { return ext_->width; }
  std::size_t field_size() const { return nodes() * width(); }

  /// Volume and volume-weighted means of at most width() − 1 values of all parcels.
  void deposit(std::int64_t parcels, std::span<const double* const> values, double* field) const {
    check([&](pileus_error* error) {
      return ext_->deposit(ext_, parcels, values.data(), static_cast<std::uint32_t>(values.size()),
                           field, error);
    });
  }
  /// The first values of the records at the parcels; sets the levels beyond the walls.
  void interpolate(std::int64_t parcels, double* field, std::span<double* const> values) const {
    check([&](pileus_error* error) {
      return ext_->interpolate(ext_, parcels, field, values.data(),
                               static_cast<std::uint32_t>(values.size()), error);
    });
  }

 private:
  template <class Call>
  static void check(Call&& call) {
    Failure failure("");
    failure.record.size = sizeof failure.record;
    failure.status = call(&failure.record);
    if (failure.status != PILEUS_OK) throw failure;
  }

  const pileus_mesh_ext* ext_ = nullptr;
};

}  // namespace pileus

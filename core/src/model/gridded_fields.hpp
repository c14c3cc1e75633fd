// The fields of an evaluated state on the nodes of its mesh.
#pragma once
#include <string>
#include <vector>

#include "dynamics/parcel_motion.hpp"
#include "dynamics/reference_profile.hpp"
#include "mesh/grid.hpp"
#include "output/netcdf_form.hpp"
#include "parcels/store.hpp"

namespace pileus::model {

/// A view of the parts of a simulation, good until the next stage or probe.
template <int D>
class GriddedFields {
 public:
  struct Parts {
    const mesh::Grid<D>& grid;
    const parcels::Store& store;
    dynamics::ParcelMotion<D>& transport;
    const std::vector<std::size_t>& tile_begin;
    const dynamics::ReferenceProfile& reference;
  };
  explicit GriddedFields(const Parts& parts) : in_(parts) {}

  /// Everything that can be gridded: "volume", velocity and vorticity components, "buoyancy", and
  /// the volume-weighted mean of any scalar of the store.
  std::vector<output::Variable> list() const;

  /// The fields of these names in file order (z slowest, x fastest), scalars several to a pass over
  /// the parcels. Throws for a name that list() does not have.
  void grid(const std::vector<std::string>& names, std::vector<std::vector<double>>& values) const;

 private:
  /// What the last evaluation left on the mesh; whether `name` is there.
  bool take_from_mesh(const std::string& name, std::vector<double>& values) const;

  Parts in_;
};

extern template class GriddedFields<2>;
extern template class GriddedFields<3>;

}  // namespace pileus::model

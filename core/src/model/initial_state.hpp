// From the fields of a scene to the values parcels start with.
#pragma once
#include "coupling/surface_fields.hpp"
#include "dynamics/parcel_motion.hpp"
#include "dynamics/reference_profile.hpp"
#include "mesh/grid.hpp"
#include "parcels/store.hpp"
#include "pileus/abi.h"
#include "scene/scene.hpp"

namespace pileus::model {

/// Takes away the parcels where the scene wants none, see scene::ParcelControl::where. Throws Error
/// (usage) when none is left.
template <int D>
void thin_parcels(const scene::Scene& scene, parcels::Store& store);

/// Gives the placed parcels of the store the scene's fields at their centres: exactly, not through
/// the mesh. A velocity becomes vorticity by differences of the sixth order (step Δ/64: truncation
/// below 1e-10 of a field that the mesh resolves) and, together with `mean_wind`, gives the
/// domain-mean wind. Scalars the scene does not set get their declared initial value.
template <int D>
void fill_initial_state(const scene::Scene& scene, const mesh::Grid<D>& grid, parcels::Store& store,
                        dynamics::MeanWind& wind);

/// What the scene's initial state says of quantities of the ground: sampled at the centres of the
/// columns of cells, z at the bottom, to be what they start with.
void give_initial_surface(const scene::Scene& scene, const pileus_grid& grid,
                          coupling::SurfaceFields& surface);

/// A field of the scene over height, tabulated at `points` heights from `bottom` to `top` (m).
/// Throws Error (usage) naming `what` when it depends on anything but height.
dynamics::ReferenceProfile profile_over_height(const scene::FieldDescription& field,
                                               const scene::Scene& scene, const char* what,
                                               double bottom, double top, int points);

}  // namespace pileus::model

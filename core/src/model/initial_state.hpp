// From the fields of a scene to the values parcels start with.
#pragma once
#include <functional>

#include "dynamics/transport.hpp"
#include "mesh/grid.hpp"
#include "parcels/store.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// Gives the placed parcels of the store the scene's fields at their centres: exactly, not through
/// the mesh. A velocity becomes vorticity by differences of the sixth order (step Δ/64: truncation
/// below 1e-10 of a field that the mesh resolves) and, together with `mean_wind`, gives the
/// domain-mean wind. Scalars the scene does not set get their declared initial value.
template <int D>
void fill_initial_state(const scene::Scene& scene, const mesh::Grid<D>& grid, parcels::Store& store,
                        dynamics::MeanWind& wind);

/// The reference buoyancy of a scene as a function of height. Throws Error (usage) when it depends
/// on anything else.
std::function<double(double)> reference_function(const scene::Scene& scene);

}  // namespace pileus::model

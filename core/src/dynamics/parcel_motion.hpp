// What moves and deforms parcels by the stages of a low-storage Runge–Kutta scheme, whatever the
// flow comes from.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "base/aligned_array.hpp"
#include "base/phase_timer.hpp"
#include "dynamics/kernels.hpp"
#include "dynamics/reference_profile.hpp"
#include "dynamics/runge_kutta.hpp"
#include "mesh/flow_options.hpp"
#include "parcels/deposit.hpp"
#include "parcels/store.hpp"

namespace pileus::dynamics {

/// Where the buoyancy of the parcels comes from: a stored quantity, or closures evaluated for the
/// present heights.
class BuoyancySource {
 public:
  virtual ~BuoyancySource() = default;
  /// Buoyancy of every parcel (m s⁻²) for the store's present state at `time` (s).
  virtual const double* buoyancy(parcels::Store& store, double time) = 0;
};

/// Horizontal mean of the velocity over the whole domain, which vorticity does not determine.
struct MeanWind {
  std::array<double, 2> velocity{0, 0};   // m s⁻¹: x, y
  std::array<double, 2> increment{0, 0};  // of the Runge–Kutta scheme
};

template <int D>
class ParcelMotion {
 public:
  virtual ~ParcelMotion() = default;
  ParcelMotion(const ParcelMotion&) = delete;
  ParcelMotion& operator=(const ParcelMotion&) = delete;

  /// Finds the flow of the state; the summary is of this state. `tile_begin` are the parcel ranges
  /// of the deposit's tiles and must stay valid until finish_step().
  virtual const mesh::FlowSummary& evaluate(parcels::Store& store, BuoyancySource& source,
                                            const std::vector<std::size_t>& tile_begin,
                                            const MeanWind& wind, double time,
                                            PhaseTimes& times) = 0;

  /// The velocity and its gradient of the present state into flow(), without tendencies: for
  /// operators between the stages and the next evaluate(), which is needed before another stage.
  virtual void evaluate_velocity(const parcels::Store& store,
                                 const std::vector<std::size_t>& tile_begin, const MeanWind& wind,
                                 PhaseTimes& times) = 0;

  /// First stage of a step of `dt` from the state just evaluated.
  virtual void begin_step(parcels::Store& store, MeanWind& wind, double dt, PhaseTimes& times) = 0;
  /// Velocity of every parcel (m s⁻¹) at the state of the last evaluate(); valid between
  /// begin_step() or probe() and the next stage.
  const double* velocity(int direction) const { return position_increment_[direction].data(); }
  /// All remaining stages; then confines the parcels to the domain.
  virtual void finish_step(parcels::Store& store, BuoyancySource& source,
                           const std::vector<std::size_t>& tile_begin, MeanWind& wind, double time,
                           double dt, PhaseTimes& times) = 0;

  /// Blunts shapes that are too long to compute with, as a step does at its end: after somebody
  /// else deformed parcels.
  void blunt_shapes(parcels::Store& store);

  /// Gives the parcels the velocity of the evaluated flow without moving them, for velocity().
  virtual void probe(parcels::Store& store, PhaseTimes& times) = 0;

  /// Records of the last evaluate(): deposited means (volume, vorticity, buoyancy perturbation) and
  /// the flow, in the layouts of mesh/grid.hpp; valid until the next stage or probe.
  virtual const double* deposited() = 0;
  const double* flow() const { return flow_.data(); }
  std::size_t empty_nodes() const { return empty_nodes_; }
  /// Shapes that a step made longer than the limit, and blunted, since the start.
  std::size_t broken_shapes() const { return broken_shapes_; }
  const ReferenceProfile& reference() const { return reference_; }
  parcels::Deposit<D>& deposit() { return deposit_; }
  /// Room for support offsets between two steps: it is the memory of the stages' increments.
  parcels::SupportOffsets<D>& offsets() { return offsets_; }
  /// Memory on the mesh, on a cache line, that is nobody's between two steps; may be none.
  virtual std::span<double> room_on_mesh() { return {}; }
  virtual std::size_t allocated_bytes() const;

 protected:
  ParcelMotion(const mesh::Grid<D>& grid, const LowStorageScheme& scheme, ShapeIntegrator shape,
               ReferenceProfile reference, double aspect_limit);

  void reserve(std::size_t parcels);
  /// Deposits volume, vorticity and the buoyancy's deviation from the reference.
  void deposit_state(parcels::Store& store, const double* buoyancy,
                     const std::vector<std::size_t>& tile_begin);
  /// Deposits volume and vorticity.
  void deposit_vorticity(const parcels::Store& store, const std::vector<std::size_t>& tile_begin);
  /// Stage `s` for all parcels; without pointers to a flow.
  StageJob<D> stage_job(parcels::Store& store, std::size_t s, double dt, bool evaluate_only);

  mesh::Grid<D> grid_;
  LowStorageScheme scheme_;
  ShapeIntegrator shape_;
  ReferenceProfile reference_;
  double aspect_limit_;  // a parcel that a step makes longer is blunted to this
  parcels::Deposit<D> deposit_;
  mesh::FlowSummary summary_;

  AlignedArray<double> deposited_, flow_;
  std::size_t empty_nodes_ = 0;
  std::size_t broken_shapes_ = 0;

 private:
  std::array<AlignedArray<double>*, parcels::SupportOffsets<D>::components> lent_arrays();

  std::vector<const double*> deposit_values_;
  AlignedArray<double> perturbation_;  // b − b_ref(z) of every parcel, for a curved reference
  std::array<AlignedArray<double>, D> position_increment_;
  std::array<AlignedArray<double>, StageJob<D>::vorticity_components> vorticity_increment_;
  std::array<AlignedArray<double>, StageJob<D>::gradient_components> shape_increment_;
  parcels::SupportOffsets<D> offsets_;
};

}  // namespace pileus::dynamics

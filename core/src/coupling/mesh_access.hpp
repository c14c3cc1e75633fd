// The mesh as operators use it; implemented where the dimension of the parcels is known.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace pileus::coupling {

/// Numbers of the whole domain that operators may ask for.
inline constexpr std::array<std::string_view, 2> mean_wind_names = {"domain_mean_x_velocity",
                                                                    "domain_mean_y_velocity"};
inline constexpr std::string_view coriolis_parameter_name = "coriolis_parameter";

/// Fields are records of record_width() doubles per node in the order of mesh/grid.hpp. All methods
/// are for the present state of the store, run their own parallel loops, and give the same bits for
/// any number of threads.
class MeshAccess {
 public:
  virtual ~MeshAccess() = default;

  virtual std::size_t nodes() const = 0;
  /// Stored levels of a column.
  virtual int levels() const = 0;
  virtual int record_width() const = 0;

  /// Volume and volume-weighted means of at most record_width() − 1 values of the parcels.
  virtual void deposit(std::span<const double* const> values, double* field) = 0;
  /// Sets the levels beyond the walls to the mirror image of those inside, as a deposit folds them.
  virtual void mirror(double* field) const = 0;
  /// The field at the parcels, levels beyond the walls as they are.
  virtual void interpolate(const double* field, std::span<double* const> values) const = 0;

  /// Solves for the flow of the present state.
  virtual void evaluate_flow() = 0;
  /// Position of a flow quantity of this dimension, or −1.
  virtual int find_flow_quantity(std::string_view name) const = 0;
  /// Copies a quantity of the flow last solved for into one lane of the records.
  virtual void copy_flow_quantity(int which, double* field, int lane) const = 0;

  /// Where a number of the whole domain is kept (pileus/abi.h lists them), or null where this run
  /// has none of that name.
  virtual double* domain_value(std::string_view name) = 0;

  /// Wraps positions sideways and reflects them at the walls, after an operator moved parcels.
  virtual void confine() = 0;
  /// Blunts shapes too long to compute with, after an operator deformed parcels.
  virtual void blunt_shapes() = 0;
};

}  // namespace pileus::coupling

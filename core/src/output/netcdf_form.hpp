// HDF5 objects laid out so that netCDF-4 readers take them for their own.
//
// The rules (NetCDF-4 file format specification; HDF5 dimension scale specification): links and
// attributes keep the order of creation, every dimension is a dimension scale, and every axis of
// every variable has its scale attached, all or none.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "output/hdf5.hpp"
#include "output/provenance.hpp"

namespace pileus::output {

/// A variable and its CF attributes. `standard_name` stays empty unless the name is in the CF
/// standard name table.
struct Variable {
  std::string name, units, long_name, standard_name{}, cell_methods{};
};

/// A fixed coordinate axis.
struct Axis {
  Variable variable;
  std::vector<double> values;
  std::string positive{};  // "up" for heights
  bool whole = false;      // stored as 32-bit integers
};

/// Variables over the same axes, which are listed from the slowest to the fastest varying.
struct VariableSet {
  std::vector<Axis> axes;
  std::vector<Variable> variables;

  /// Values of one variable at one time.
  std::size_t record_size() const;
};

/// How numbers are stored.
struct Encoding {
  bool exact = false;     // float64; else float32
  bool compress = true;   // shuffle and gzip level 1
  int mantissa_bits = 0;  // explicit mantissa bits kept (round half to even); 0: all

  std::size_t value_bytes() const { return exact ? sizeof(double) : sizeof(float); }
  hid_t file_type() const { return exact ? H5T_IEEE_F64LE : H5T_IEEE_F32LE; }
  hid_t memory_type() const { return exact ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT; }
};

/// The variable that holds the intervals of records; time refers to it where it exists.
inline constexpr const char* time_bounds_name = "time_bnds";

/// Real times decode to dates in xarray with this epoch; CF demands one.
inline constexpr const char* time_units = "seconds since 2000-01-01 00:00:00";

/// Keeps `bits` explicit mantissa bits of a finite value, rounding half to even.
double round_mantissa(double value, int bits);

/// Converts values for storage. Returns a pointer into `floats`, into `doubles`, or to the values
/// themselves when they need no change. A value beyond float32 becomes infinite.
const void* encode(std::span<const double> values, const Encoding& encoding,
                   std::vector<float>& floats, std::vector<double>& doubles);

/// Global attributes (Conventions, title, source, history, seeds) and the variable `scene`.
void write_provenance(const hdf5::Session& session, hid_t group, const Provenance& provenance);

/// Type of texts of any length, for variables of words.
hdf5::Id variable_length_text(const hdf5::Session& session);

/// The CF attributes standard_name, long_name and units, those that are known.
void write_description(const hdf5::Session& session, hid_t dataset, const Variable& variable);

/// The unlimited coordinate `time`, empty.
hdf5::Id create_time(const hdf5::Session& session, hid_t group);

/// A fixed coordinate variable with its values.
hdf5::Id create_axis(const hdf5::Session& session, hid_t group, const Axis& axis);

/// An unlimited dimension without coordinate values.
hdf5::Id create_bare_dimension(const hdf5::Session& session, hid_t group, const std::string& name);

/// Shape of a variable: one scale, current extent, limit and chunk length per axis.
struct VariableShape {
  std::vector<hid_t> scales;
  std::vector<hsize_t> extent, maximum, chunk;
};

/// A data variable of `type` with its dimension scales and CF attributes.
hdf5::Id create_variable(const hdf5::Session& session, hid_t group, const Variable& variable,
                         hid_t type, const VariableShape& shape, bool compress);

/// As above, for floating-point numbers: fill value NaN, rounding recorded.
hdf5::Id create_variable(const hdf5::Session& session, hid_t group, const Variable& variable,
                         const Encoding& encoding, const VariableShape& shape);

/// The number of leading entries of an ascending time coordinate that are ≤ `time`.
std::uint64_t records_until(std::span<const double> times, double time);

}  // namespace pileus::output

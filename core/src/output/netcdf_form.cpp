#include "output/netcdf_form.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace pileus::output {

using hdf5::Id;
using hdf5::Session;

std::size_t VariableSet::record_size() const {
  std::size_t size = 1;
  for (const Axis& axis : axes) size *= axis.values.size();
  return size;
}

double round_mantissa(double value, int bits) {
  constexpr int mantissa = std::numeric_limits<double>::digits - 1;
  if (bits <= 0 || bits >= mantissa || !std::isfinite(value)) return value;
  const int dropped = mantissa - bits;
  auto pattern = std::bit_cast<std::uint64_t>(value);
  // Half of the last kept bit, less one when that bit is even: ties fall to even.
  pattern += (std::uint64_t{1} << (dropped - 1)) - 1 + ((pattern >> dropped) & 1);
  pattern &= ~((std::uint64_t{1} << dropped) - 1);
  return std::bit_cast<double>(pattern);
}

const void* encode(std::span<const double> values, const Encoding& encoding,
                   std::vector<float>& floats, std::vector<double>& doubles) {
  const int bits = encoding.mantissa_bits;
  if (encoding.exact && bits == 0) return values.data();
  if (encoding.exact) {
    doubles.resize(values.size());
    std::transform(values.begin(), values.end(), doubles.begin(),
                   [bits](double value) { return round_mantissa(value, bits); });
    return doubles.data();
  }
  floats.resize(values.size());
  std::transform(values.begin(), values.end(), floats.begin(),
                 [bits](double value) { return static_cast<float>(round_mantissa(value, bits)); });
  return floats.data();
}

void write_provenance(const Session& session, hid_t group, const Provenance& provenance) {
  hdf5::write_attribute(session, group, "Conventions", "CF-1.10");
  hdf5::write_attribute(session, group, "title", provenance.title);
  hdf5::write_attribute(session, group, "source", provenance.source);
  hdf5::write_attribute(session, group, "history", provenance.history);
  for (const auto& [name, value] : provenance.attributes)
    hdf5::write_attribute(session, group, name, value);
  for (const auto& [name, seed] : provenance.seeds)
    hdf5::write_attribute(session, group, "seed_" + name, H5T_NATIVE_UINT64, &seed);
  hdf5::write_text(session, group, "scene", provenance.scene);
  const Id scene = hdf5::open_dataset(session, group, "scene");
  hdf5::write_attribute(session, scene, "long_name", "scene with every default filled in (YAML)");
}

void write_description(const Session& session, hid_t dataset, const Variable& variable) {
  if (!variable.standard_name.empty())
    hdf5::write_attribute(session, dataset, "standard_name", variable.standard_name);
  if (!variable.long_name.empty())
    hdf5::write_attribute(session, dataset, "long_name", variable.long_name);
  if (!variable.units.empty()) hdf5::write_attribute(session, dataset, "units", variable.units);
  if (!variable.cell_methods.empty())
    hdf5::write_attribute(session, dataset, "cell_methods", variable.cell_methods);
}

Id variable_length_text(const Session& session) {
  Id type(session.check(H5Tcopy(H5T_C_S1), "describe text"));
  session.check(H5Tset_size(type, H5T_VARIABLE), "describe text");
  session.check(H5Tset_cset(type, H5T_CSET_UTF8), "describe text");
  return type;
}

namespace {

Id create_unlimited(const Session& session, hid_t group, const std::string& name, hid_t type,
                    const std::string& scale_name) {
  const Id list = hdf5::dataset_list(session);
  const hsize_t extent[] = {0}, maximum[] = {H5S_UNLIMITED}, chunk[] = {512};
  session.check(H5Pset_chunk(list, 1, chunk), "create dimension " + name);
  Id dataset = hdf5::create_dataset(session, group, name, type, extent, maximum, list);
  session.check(H5DSset_scale(dataset, scale_name.c_str()), "create dimension " + name);
  return dataset;
}

template <class T>
void write_nan_fill_attribute(const Session& session, hid_t dataset, hid_t type) {
  const T nan = std::numeric_limits<T>::quiet_NaN();
  const hsize_t one[] = {1};
  const Id space(session.check(H5Screate_simple(1, one, nullptr), "write attribute _FillValue"));
  const Id attribute(
      session.check(H5Acreate2(dataset, "_FillValue", type, space, H5P_DEFAULT, H5P_DEFAULT),
                    "write attribute _FillValue"));
  session.check(H5Awrite(attribute, type, &nan), "write attribute _FillValue");
}

Id create_shaped(const Session& session, hid_t group, const Variable& variable, hid_t type,
                 const VariableShape& shape, bool compress, const double* fill) {
  const std::string operation = "create variable " + variable.name;
  const Id list = hdf5::dataset_list(session);
  const int rank = static_cast<int>(shape.chunk.size());
  session.check(H5Pset_chunk(list, rank, shape.chunk.data()), operation);
  if (compress) {
    session.check(H5Pset_shuffle(list), operation);
    session.check(H5Pset_deflate(list, 1), operation);
  }
  if (fill != nullptr) session.check(H5Pset_fill_value(list, H5T_NATIVE_DOUBLE, fill), operation);
  Id dataset =
      hdf5::create_dataset(session, group, variable.name, type, shape.extent, shape.maximum, list);
  for (int axis = 0; axis < rank; ++axis)
    session.check(H5DSattach_scale(dataset, shape.scales[static_cast<std::size_t>(axis)],
                                   static_cast<unsigned>(axis)),
                  operation);
  write_description(session, dataset, variable);
  return dataset;
}

}  // namespace

Id create_time(const Session& session, hid_t group) {
  Id dataset = create_unlimited(session, group, "time", H5T_IEEE_F64LE, "time");
  write_description(session, dataset,
                    {"time", time_units, "time since the start of the simulation", "time"});
  hdf5::write_attribute(session, dataset, "calendar", "standard");
  return dataset;
}

Id create_axis(const Session& session, hid_t group, const Axis& axis) {
  const std::string& name = axis.variable.name;
  hdf5::write_array(session, group, name, axis.whole ? H5T_STD_I32LE : H5T_IEEE_F64LE,
                    H5T_NATIVE_DOUBLE, axis.values.data(), axis.values.size());
  Id dataset = hdf5::open_dataset(session, group, name);
  session.check(H5DSset_scale(dataset, name.c_str()), "create dimension " + name);
  write_description(session, dataset, axis.variable);
  if (!axis.positive.empty()) hdf5::write_attribute(session, dataset, "positive", axis.positive);
  return dataset;
}

Id create_bare_dimension(const Session& session, hid_t group, const std::string& name) {
  // The name netCDF-4 gives a scale that stands for a dimension only; readers compare its start.
  const std::string scale_name =
      fmt::format("This is a netCDF dimension but not a netCDF variable. {:10d}", 0);
  return create_unlimited(session, group, name, H5T_IEEE_F32BE, scale_name);
}

Id create_variable(const Session& session, hid_t group, const Variable& variable, hid_t type,
                   const VariableShape& shape, bool compress) {
  return create_shaped(session, group, variable, type, shape, compress, nullptr);
}

Id create_variable(const Session& session, hid_t group, const Variable& variable,
                   const Encoding& encoding, const VariableShape& shape) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Id dataset =
      create_shaped(session, group, variable, encoding.file_type(), shape, encoding.compress, &nan);
  if (encoding.exact)
    write_nan_fill_attribute<double>(session, dataset, H5T_NATIVE_DOUBLE);
  else
    write_nan_fill_attribute<float>(session, dataset, H5T_NATIVE_FLOAT);
  if (encoding.mantissa_bits > 0)
    hdf5::write_attribute(session, dataset, "_QuantizeBitRoundNumberOfSignificantBits",
                          H5T_NATIVE_INT, &encoding.mantissa_bits);
  return dataset;
}

std::uint64_t records_until(std::span<const double> times, double time) {
  return static_cast<std::uint64_t>(std::upper_bound(times.begin(), times.end(), time) -
                                    times.begin());
}

}  // namespace pileus::output

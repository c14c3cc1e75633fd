// XDMF: small XML files beside the HDF5 files that tell ParaView and VTK how to read them.
//
// Version 2 of the format, for the reader ParaView calls "XDMF Reader".
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "output/netcdf_form.hpp"

namespace pileus::output {

/// Replaces the sidecar of a file of gridded fields: a regular mesh per record.
void write_field_sidecar(const std::filesystem::path& sidecar, const std::filesystem::path& data,
                         const std::vector<Axis>& axes, const std::vector<Variable>& variables,
                         const Encoding& encoding, const std::vector<double>& times);

/// One point cloud of a ragged array.
struct PointRecord {
  double time = 0;          // s
  std::uint64_t count = 0;  // points
};

/// Replaces the sidecar of a file of parcels: a cloud of points per record. `positions` are the
/// names of the two or three coordinate variables, all in group `group` like the others.
void write_point_sidecar(const std::filesystem::path& sidecar, const std::filesystem::path& data,
                         const std::string& group, const std::vector<std::string>& positions,
                         const std::vector<Variable>& variables, const Encoding& encoding,
                         const std::vector<PointRecord>& records);

}  // namespace pileus::output

#include "output/xdmf.hpp"

#include <fmt/format.h>

#include <string_view>

#include "output/posix_file.hpp"

namespace pileus::output {

namespace {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&')
      result += "&amp;";
    else if (c == '<')
      result += "&lt;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

/// One record of an array in the file: start, count and whole extent along each of its axes.
struct Slab {
  std::vector<std::uint64_t> start, count, whole;
};

std::string joined(const std::vector<std::uint64_t>& numbers) {
  return fmt::format("{}", fmt::join(numbers, " "));
}

/// A hyperslab: start, stride and count, then the array it is cut from. `shape` is the result's.
std::string slab_item(const Slab& slab, const std::string& shape, const Encoding& encoding,
                      const std::string& source) {
  const std::vector<std::uint64_t> stride(slab.start.size(), 1);
  return fmt::format(
      "<DataItem ItemType=\"HyperSlab\" Type=\"HyperSlab\" Dimensions=\"{}\">"
      "<DataItem Dimensions=\"3 {}\" Format=\"XML\">{} {} {}</DataItem>"
      "<DataItem NumberType=\"Float\" Precision=\"{}\" Dimensions=\"{}\" Format=\"HDF\">{}"
      "</DataItem></DataItem>",
      shape, slab.start.size(), joined(slab.start), joined(stride), joined(slab.count),
      encoding.value_bytes(), joined(slab.whole), source);
}

std::string document(const std::string& name, const std::string& grids) {
  return fmt::format(
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
      "<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n{}"
      "</Grid>\n</Domain>\n</Xdmf>\n",
      escaped(name), grids);
}

std::string attribute(const Variable& variable, const std::string& item) {
  return fmt::format(
      "<Attribute Name=\"{}\" AttributeType=\"Scalar\" Center=\"Node\">{}"
      "</Attribute>\n",
      escaped(variable.name), item);
}

/// Origin and spacing of a three-dimensional mesh, slowest axis first; an axis of one node gets
/// spacing 1. Two-dimensional fields lie in the plane of the first two coordinates, as the X_Y
/// points of two-dimensional parcels and ParaView's netCDF reader have it.
std::string regular_geometry(const std::vector<Axis>& axes) {
  std::vector<double> origin(3 - axes.size(), 0.0), spacing(3 - axes.size(), 1.0);
  for (const Axis& axis : axes) {
    origin.push_back(axis.values.front());
    spacing.push_back(axis.values.size() > 1 ? axis.values[1] - axis.values[0] : 1.0);
  }
  return fmt::format(
      "<Geometry GeometryType=\"ORIGIN_DXDYDZ\">"
      "<DataItem Dimensions=\"3\" Format=\"XML\">{}</DataItem>"
      "<DataItem Dimensions=\"3\" Format=\"XML\">{}</DataItem></Geometry>\n",
      fmt::join(origin, " "), fmt::join(spacing, " "));
}

}  // namespace

void write_field_sidecar(const std::filesystem::path& sidecar, const std::filesystem::path& data,
                         const std::vector<Axis>& axes, const std::vector<Variable>& variables,
                         const Encoding& encoding, const std::vector<double>& times) {
  const std::string file = escaped(data.filename().string());
  std::vector<std::uint64_t> nodes;
  for (const Axis& axis : axes) nodes.push_back(axis.values.size());
  const std::string shape = (axes.size() == 2 ? "1 " : "") + joined(nodes);
  std::string grids;
  for (std::size_t record = 0; record < times.size(); ++record) {
    Slab slab{{record}, {1}, {times.size()}};
    for (const std::uint64_t n : nodes) {
      slab.start.push_back(0);
      slab.count.push_back(n);
      slab.whole.push_back(n);
    }
    grids += fmt::format(
        "<Grid Name=\"fields\" GridType=\"Uniform\"><Time Value=\"{}\"/>\n"
        "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{}\"/>\n{}",
        times[record], shape, regular_geometry(axes));
    for (const Variable& variable : variables)
      grids += attribute(variable, slab_item(slab, shape, encoding,
                                             fmt::format("{}:/{}", file, escaped(variable.name))));
    grids += "</Grid>\n";
  }
  replace_file(sidecar, document("fields", grids), false);
}

void write_point_sidecar(const std::filesystem::path& sidecar, const std::filesystem::path& data,
                         const std::string& group, const std::vector<std::string>& positions,
                         const std::vector<Variable>& variables, const Encoding& encoding,
                         const std::vector<PointRecord>& records) {
  const std::string source = fmt::format("{}:/{}/", escaped(data.filename().string()), group);
  std::uint64_t total = 0, first = 0;
  for (const PointRecord& record : records) total += record.count;
  std::string grids;
  for (const PointRecord& record : records) {
    const Slab slab{{first}, {record.count}, {total}};
    const std::string shape = fmt::format("{}", record.count);
    grids += fmt::format(
        "<Grid Name=\"parcels\" GridType=\"Uniform\"><Time Value=\"{}\"/>\n"
        "<Topology TopologyType=\"Polyvertex\" NodesPerElement=\"1\" NumberOfElements=\"{}\"/>\n"
        "<Geometry GeometryType=\"{}\">",
        record.time, record.count, positions.size() == 3 ? "X_Y_Z" : "X_Y");
    for (const std::string& position : positions)
      grids += slab_item(slab, shape, encoding, source + position);
    grids += "</Geometry>\n";
    for (const Variable& variable : variables)
      grids += attribute(variable, slab_item(slab, shape, encoding, source + variable.name));
    grids += "</Grid>\n";
    first += record.count;
  }
  replace_file(sidecar, document("parcels", grids), false);
}

}  // namespace pileus::output

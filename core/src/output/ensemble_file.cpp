#include "output/ensemble_file.hpp"

#include <hdf5_hl.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace pileus::output {

using hdf5::Id;
using hdf5::Session;

namespace {

Encoding exact_encoding() {
  Encoding exact;
  exact.exact = true;
  return exact;
}

class EnsembleWriter {
 public:
  EnsembleWriter(const Session& session, const EnsembleContent& content)
      : session_(session), content_(content) {}

  void write() {
    hdf5::write_text(session_, session_.file(), "sweep", content_.sweep);
    std::vector<double> indices(content_.members);
    std::iota(indices.begin(), indices.end(), 0.0);
    add_axis({{"member", "1", "index of the member", "realization"}, std::move(indices), "", true});
    for (const Axis& axis : content_.axes) add_axis(axis);
    write_columns();
    for (const MemberVariable& variable : content_.variables) write(variable);
    for (const StatisticVariable& statistic : content_.statistics) write(statistic);
  }

 private:
  void add_axis(const Axis& axis) {
    const std::string& name = axis.variable.name;
    scales_.emplace(name, create_axis(session_, session_.file(), axis));
    lengths_[name] = axis.values.size();
    if (axis.variable.units == time_units)
      hdf5::write_attribute(session_, scales_.at(name), "calendar", "standard");
  }

  void write_columns() {
    const VariableShape shape = shape_of({"member"});
    for (const NumberColumn& column : content_.numbers) {
      write_values(create_column(session_, column, shape), shape, column.values);
      note_coordinate(column.variable.name);
    }
    const Id text = variable_length_text(session_);
    for (const WordColumn& column : content_.words) {
      const Id dataset =
          create_variable(session_, session_.file(), column.variable, text, shape, false);
      std::vector<const char*> pointers;
      for (const std::string& word : column.values) pointers.push_back(word.c_str());
      const std::vector<hsize_t> start = {0};
      hdf5::write_slab(session_, dataset, start, shape.extent, text, pointers.data());
      note_coordinate(column.variable.name);
    }
  }

  void note_coordinate(const std::string& name) {
    coordinates_ += (coordinates_.empty() ? "" : " ") + name;
  }

  void write(const MemberVariable& variable) {
    std::vector<std::string> axes = {"member"};
    axes.insert(axes.end(), variable.axes.begin(), variable.axes.end());
    const VariableShape shape = shape_of(axes);
    const bool referred = !variable.sources.empty();
    const Id dataset = referred ? create_references(variable, shape)
                                : create_variable(session_, session_.file(), variable.variable,
                                                  exact_encoding(), shape);
    if (!referred) write_values(dataset, shape, variable.values);
    if (!coordinates_.empty())
      hdf5::write_attribute(session_, dataset, "coordinates", coordinates_);
  }

  void write(const StatisticVariable& statistic) {
    const VariableShape shape = shape_of(statistic.axes);
    const Id dataset =
        create_variable(session_, session_.file(), statistic.variable, exact_encoding(), shape);
    write_values(dataset, shape, statistic.values);
    if (!statistic.cell_methods.empty())
      hdf5::write_attribute(session_, dataset, "cell_methods", statistic.cell_methods);
  }

  void write_values(hid_t dataset, const VariableShape& shape,
                    const std::vector<double>& values) const {
    const std::vector<hsize_t> start(shape.extent.size(), 0);
    if (!values.empty())
      hdf5::write_slab(session_, dataset, start, shape.extent, H5T_NATIVE_DOUBLE, values.data());
  }

  VariableShape shape_of(const std::vector<std::string>& axes) const {
    constexpr hsize_t longest_chunk = 65536;  // values: half a megabyte
    VariableShape shape;
    for (const std::string& axis : axes) {
      shape.scales.push_back(scales_.at(axis));
      shape.extent.push_back(lengths_.at(axis));
    }
    shape.maximum = shape.extent;
    shape.chunk.resize(axes.size());
    hsize_t room = longest_chunk;
    for (std::size_t a = axes.size(); a-- > 0;) {
      shape.chunk[a] = std::clamp<hsize_t>(shape.extent[a], 1, room);
      room = std::max<hsize_t>(1, room / shape.chunk[a]);
    }
    return shape;
  }

  /// A variable whose rows are variables of other files.
  Id create_references(const MemberVariable& variable, const VariableShape& shape) const {
    const std::string& name = variable.variable.name;
    const std::string operation = "refer to variable " + name;
    const int rank = static_cast<int>(shape.extent.size());
    const Id list = hdf5::dataset_list(session_);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    session_.check(H5Pset_fill_value(list, H5T_NATIVE_DOUBLE, &nan), operation);
    const Id whole(session_.check(H5Screate_simple(rank, shape.extent.data(), nullptr), operation));
    const Id row(
        session_.check(H5Screate_simple(rank - 1, shape.extent.data() + 1, nullptr), operation));
    std::vector<hsize_t> start(shape.extent.size(), 0), count = shape.extent;
    count.front() = 1;
    for (std::size_t m = 0; m < variable.sources.size(); ++m) {
      if (variable.sources[m].empty()) continue;
      start.front() = m;
      session_.check(
          H5Sselect_hyperslab(whole, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
          operation);
      session_.check(H5Pset_virtual(list, whole, variable.sources[m].c_str(),
                                    variable.source_name.c_str(), row),
                     operation);
    }
    Id dataset = hdf5::create_dataset(session_, session_.file(), name, H5T_IEEE_F64LE, shape.extent,
                                      {}, list);
    for (int axis = 0; axis < rank; ++axis)
      session_.check(H5DSattach_scale(dataset, shape.scales[static_cast<std::size_t>(axis)],
                                      static_cast<unsigned>(axis)),
                     operation);
    write_description(session_, dataset, variable.variable);
    return dataset;
  }

  const Session& session_;
  const EnsembleContent& content_;
  std::map<std::string, Id> scales_;
  std::map<std::string, hsize_t> lengths_;
  std::string coordinates_;
};

}  // namespace

void write_ensemble(const std::filesystem::path& path, const EnsembleContent& content,
                    const Provenance& provenance) {
  Session session = Session::create_with_references(path);
  write_provenance(session, session.file(), provenance);
  EnsembleWriter(session, content).write();
  session.commit();
}

}  // namespace pileus::output

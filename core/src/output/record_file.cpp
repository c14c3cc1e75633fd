#include "output/record_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace pileus::output {

using hdf5::Id;
using hdf5::Session;

namespace {
/// Chunks of about this size: few enough to list quickly, small enough that a section of a field
/// reads little more than it needs.
constexpr std::size_t largest_chunk_bytes = std::size_t{4} << 20;
/// Records smaller than this share chunks, which then stay uncompressed: rewriting a compressed
/// chunk at every append would leave its old copy behind as dead space.
constexpr std::size_t small_record_bytes = 4096;
}  // namespace

RecordFile::RecordFile(std::filesystem::path path, VariableSet main, VariableSet second,
                       Provenance provenance, Encoding encoding, Start start)
    : path_(std::move(path)),
      sets_{std::move(main), std::move(second)},
      provenance_(std::move(provenance)),
      encoding_(encoding) {
  if (record_size() * encoding_.value_bytes() < small_record_bytes) encoding_.compress = false;
  refuse_existing(path_, start);
  if (start.kind == Start::Kind::resume && std::filesystem::exists(path_)) resume(start.time);
}

void RecordFile::append(double time, std::span<const std::vector<double>> values) {
  append_records(std::span(&time, 1), values);
}

void RecordFile::append_records(std::span<const double> times,
                                std::span<const std::vector<double>> values) {
  const std::size_t declared = sets_[0].variables.size() + sets_[1].variables.size();
  if (values.size() != declared)
    throw std::invalid_argument(fmt::format("{}: {} variables given, {} declared", path_.string(),
                                            values.size(), declared));
  std::size_t v = 0;
  for (const VariableSet& set : sets_)
    for (const Variable& variable : set.variables) {
      const std::size_t expected = set.record_size() * times.size();
      if (values[v].size() != expected)
        throw std::invalid_argument(fmt::format("{}: {} values of {}, {} expected", path_.string(),
                                                values[v].size(), variable.name, expected));
      ++v;
    }
  if (times.empty()) return;
  require_later(path_, times_, times);
  Session session = exists_ ? Session::update(path_) : Session::create(path_);
  if (!exists_) create(session);
  extend(session, times, values);
  session.commit();
  exists_ = true;
  times_.insert(times_.end(), times.begin(), times.end());
}

VariableShape RecordFile::shape(const VariableSet& set, std::vector<hid_t> scales) const {
  VariableShape shape{std::move(scales), {0}, {H5S_UNLIMITED}, {1}};
  const std::size_t record_bytes = set.record_size() * encoding_.value_bytes();
  if (record_bytes < small_record_bytes) shape.chunk[0] = small_record_bytes / record_bytes;
  for (const Axis& axis : set.axes) {
    shape.extent.push_back(axis.values.size());
    shape.maximum.push_back(axis.values.size());
    shape.chunk.push_back(axis.values.size());
  }
  if (!set.axes.empty() && record_bytes > largest_chunk_bytes) {
    // Slabs of nearly equal thickness: a thin last one would take the room of a full one.
    const std::size_t levels = set.axes.front().values.size();
    const std::size_t slabs = std::min(levels, record_bytes / largest_chunk_bytes + 1);
    shape.chunk[1] = (levels + slabs - 1) / slabs;
  }
  return shape;
}

void RecordFile::create(const Session& session) const {
  write_provenance(session, session.file(), provenance_);
  const Id time = create_time(session, session.file());
  for (const VariableSet& set : sets_) {
    if (set.variables.empty()) continue;
    std::vector<Id> axes;
    std::vector<hid_t> scales{time};
    for (const Axis& axis : set.axes) {
      const std::string& name = axis.variable.name;
      axes.push_back(hdf5::has_object(session.file(), name)
                         ? hdf5::open_dataset(session, session.file(), name)
                         : create_axis(session, session.file(), axis));
      scales.push_back(axes.back());
    }
    const VariableShape over_axes = shape(set, scales);
    Encoding encoding = encoding_;
    if (set.record_size() * encoding.value_bytes() < small_record_bytes) encoding.compress = false;
    for (const Variable& variable : set.variables) {
      create_variable(session, session.file(), variable, encoding, over_axes);
      if (variable.name == time_bounds_name)
        hdf5::write_attribute(session, time, "bounds", time_bounds_name);
    }
  }
}

void RecordFile::extend(const Session& session, std::span<const double> times,
                        std::span<const std::vector<double>> values) {
  const Id time = hdf5::open_dataset(session, session.file(), "time");
  const std::vector<hsize_t> start = hdf5::extent_of(session, time);
  if (start != std::vector<hsize_t>{times_.size()})
    throw Error(ExitCode::file, fmt::format("{}: another program changed the file: {} records "
                                            "were expected, {} are there.",
                                            path_.string(), times_.size(), start.at(0)));
  const std::vector<hsize_t> count{times.size()}, end{start[0] + times.size()};
  session.check(H5Dset_extent(time, end.data()), "extend time");
  hdf5::write_slab(session, time, start, count, H5T_NATIVE_DOUBLE, times.data());
  const std::size_t main = sets_[0].variables.size();
  extend(session, sets_[0], times.size(), values.first(main));
  extend(session, sets_[1], times.size(), values.subspan(main));
}

void RecordFile::extend(const Session& session, const VariableSet& set, std::size_t records,
                        std::span<const std::vector<double>> values) {
  std::vector<hsize_t> start{times_.size()}, count{records}, end{times_.size() + records};
  for (const Axis& axis : set.axes) {
    start.push_back(0);
    count.push_back(axis.values.size());
    end.push_back(axis.values.size());
  }
  for (std::size_t v = 0; v < set.variables.size(); ++v) {
    const std::string& name = set.variables[v].name;
    const Id dataset = hdf5::open_dataset(session, session.file(), name);
    session.check(H5Dset_extent(dataset, end.data()), "extend " + name);
    const void* data = encode(values[v], encoding_, floats_, doubles_);
    hdf5::write_slab(session, dataset, start, count, encoding_.memory_type(), data);
  }
}

void RecordFile::resume(double time) {
  Session session = Session::update(path_);
  times_ = hdf5::read_array<double>(session, session.file(), "time");
  times_.resize(records_until(times_, time));
  const Id time_axis = hdf5::open_dataset(session, session.file(), "time");
  const hsize_t records = times_.size();
  session.check(H5Dset_extent(time_axis, &records), "shorten time");
  for (const VariableSet& set : sets_) resume(session, set);
  session.commit();
  exists_ = true;
}

/// Shortens the variables to the records that stay.
void RecordFile::resume(const Session& session, const VariableSet& set) const {
  std::vector<hsize_t> extent{times_.size()};
  for (const Axis& axis : set.axes) extent.push_back(axis.values.size());
  for (const Variable& variable : set.variables) {
    if (!hdf5::has_object(session.file(), variable.name))
      throw Error(ExitCode::file,
                  fmt::format("{}: the file of the run to resume has no variable {}.",
                              path_.string(), variable.name));
    const Id dataset = hdf5::open_dataset(session, session.file(), variable.name);
    std::vector<hsize_t> found = hdf5::extent_of(session, dataset);
    const bool longer = !found.empty() && found[0] >= extent[0];
    if (longer) found[0] = extent[0];
    if (found != extent)
      throw Error(ExitCode::file,
                  fmt::format("{}: variable {} of the run to resume has another shape.",
                              path_.string(), variable.name));
    session.check(H5Dset_extent(dataset, extent.data()), "shorten " + variable.name);
  }
}

}  // namespace pileus::output

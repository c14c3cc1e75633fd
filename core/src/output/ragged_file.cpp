#include "output/ragged_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "output/xdmf.hpp"

namespace pileus::output {

using hdf5::Id;
using hdf5::Session;

namespace {

/// Values per chunk: a quarter megabyte of float64, little to rewrite when a record ends inside.
constexpr hsize_t chunk_values = 32768;

Id open_group(const Session& session, const std::string& name) {
  return Id(session.check(H5Gopen2(session.file(), name.c_str(), H5P_DEFAULT), "open " + name));
}

void append_to(const Session& session, hid_t group, const std::string& name, hsize_t first,
               hsize_t added, hid_t memory_type, const void* data) {
  const Id dataset = hdf5::open_dataset(session, group, name);
  const hsize_t start[] = {first}, count[] = {added}, end[] = {first + added};
  session.check(H5Dset_extent(dataset, end), "extend " + name);
  if (added > 0 && data != nullptr)
    hdf5::write_slab(session, dataset, start, count, memory_type, data);
}

}  // namespace

std::vector<Variable> position_variables(int dimension, const std::string& of_what) {
  std::vector<Variable> positions;
  for (const char* axis : {"x", "y", "z"})
    if (dimension == 3 || *axis != 'y')
      positions.push_back({fmt::format("{}_position", axis), "m",
                           fmt::format("{} coordinate of {}", axis, of_what)});
  return positions;
}

RaggedFile::RaggedFile(std::filesystem::path path, RaggedContent content, Provenance provenance,
                       Encoding encoding, Start start)
    : path_(std::move(path)),
      content_(std::move(content)),
      provenance_(std::move(provenance)),
      encoding_(encoding) {
  encoding_.compress = false;
  std::erase_if(content_.columns, [this](const Variable& column) {
    return std::any_of(content_.positions.begin(), content_.positions.end(),
                       [&](const Variable& position) { return position.name == column.name; });
  });
  refuse_existing(path_, start);
  if (start.kind == Start::Kind::resume && std::filesystem::exists(path_)) resume(start.time);
}

std::uint64_t RaggedFile::total() const {
  return std::accumulate(row_sizes_.begin(), row_sizes_.end(), std::uint64_t{0});
}

void RaggedFile::append(double time, const RaggedRecord& record) {
  require_later(path_, times_, std::span(&time, 1));
  Session session = exists_ ? Session::update(path_) : Session::create(path_);
  if (!exists_) create(session);
  extend(session, time, record);
  session.commit();
  exists_ = true;
  times_.push_back(time);
  row_sizes_.push_back(record.size);
  write_sidecar();
}

void RaggedFile::create(const Session& session) const {
  write_provenance(session, session.file(), provenance_);
  const Id group = hdf5::create_group(session, session.file(), content_.group);
  const Id time = create_time(session, group);
  const Id obs = create_bare_dimension(session, group, "obs");
  const Id row_size = create_variable(session, group, {"row_size", "1", content_.counted},
                                      H5T_STD_I64LE, {{time}, {0}, {H5S_UNLIMITED}, {512}}, false);
  hdf5::write_attribute(session, row_size, "sample_dimension", "obs");
  const VariableShape over_things{{obs}, {0}, {H5S_UNLIMITED}, {chunk_values}};
  for (const Variable& variable : content_.wholes)
    create_variable(session, group, variable, H5T_STD_U64LE, over_things, false);
  for (const Variable& variable : content_.positions)
    create_variable(session, group, variable, encoding_, over_things);
  for (const Variable& variable : content_.columns)
    create_variable(session, group, variable, encoding_, over_things);
}

void RaggedFile::extend(const Session& session, double time, const RaggedRecord& things) {
  const Id group = open_group(session, content_.group);
  const Id time_axis = hdf5::open_dataset(session, group, "time");
  if (hdf5::extent_of(session, time_axis) != std::vector<hsize_t>{times_.size()})
    throw Error(ExitCode::file,
                fmt::format("{}: another program changed the file while the model was running.",
                            path_.string()));
  const hsize_t record = times_.size(), first = total(), added = things.size;
  append_to(session, group, "time", record, 1, H5T_NATIVE_DOUBLE, &time);
  append_to(session, group, "row_size", record, 1, H5T_NATIVE_UINT64, &added);
  append_to(session, group, "obs", first, added, H5T_NATIVE_FLOAT, nullptr);
  for (std::size_t v = 0; v < content_.wholes.size(); ++v)
    append_to(session, group, content_.wholes[v].name, first, added, H5T_NATIVE_UINT64,
              things.wholes.at(v));
  const auto write = [&](const Variable& variable, const double* values) {
    const void* data = encode({values, things.size}, encoding_, floats_, doubles_);
    append_to(session, group, variable.name, first, added, encoding_.memory_type(), data);
  };
  for (std::size_t v = 0; v < content_.positions.size(); ++v)
    write(content_.positions[v], things.positions.at(v));
  for (std::size_t v = 0; v < content_.columns.size(); ++v)
    write(content_.columns[v], things.columns.at(v));
}

void RaggedFile::resume(double time) {
  {
    Session session = Session::update(path_);
    const Id group = open_group(session, content_.group);
    times_ = hdf5::read_array<double>(session, group, "time");
    times_.resize(records_until(times_, time));
    row_sizes_ = hdf5::read_array<std::uint64_t>(session, group, "row_size");
    row_sizes_.resize(times_.size());
    auto shorten = [&](const std::string& name, hsize_t length) {
      if (!hdf5::has_object(group, name))
        throw Error(ExitCode::file,
                    fmt::format("{}: the file of the run to resume has no variable {}.",
                                path_.string(), name));
      const Id dataset = hdf5::open_dataset(session, group, name);
      if (hdf5::extent_of(session, dataset).at(0) < length)
        throw Error(ExitCode::file, fmt::format("{}: variable {} of the run to resume is shorter "
                                                "than its row sizes say.",
                                                path_.string(), name));
      session.check(H5Dset_extent(dataset, &length), "shorten " + name);
    };
    for (const char* name : {"time", "row_size"}) shorten(name, times_.size());
    shorten("obs", total());
    for (const auto* list : {&content_.wholes, &content_.positions, &content_.columns})
      for (const Variable& variable : *list) shorten(variable.name, total());
    session.commit();
  }
  exists_ = true;
  if (!times_.empty()) write_sidecar();
}

void RaggedFile::write_sidecar() const {
  std::filesystem::path sidecar = path_;
  sidecar.replace_extension(".xmf");
  std::vector<std::string> positions;
  for (const Variable& position : content_.positions) positions.push_back(position.name);
  std::vector<PointRecord> records;
  for (std::size_t k = 0; k < times_.size(); ++k) records.push_back({times_[k], row_sizes_[k]});
  write_point_sidecar(sidecar, path_, content_.group, positions, content_.columns, encoding_,
                      records);
}

}  // namespace pileus::output

#include "output/read_fields.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include "base/error.hpp"

namespace pileus::output {

namespace {

bool is_numeric(const hdf5::Session& session, hid_t dataset) {
  const hid_t type = session.check(H5Dget_type(dataset), "read the type of a variable");
  const H5T_class_t kind = H5Tget_class(type);
  H5Tclose(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

std::string optional_text(const hdf5::Session& session, hid_t object, const char* name) {
  return H5Aexists(object, name) > 0 ? hdf5::read_text_attribute(session, object, name)
                                     : std::string();
}

/// Takes the name of the first scale attached to an axis and ends the iteration.
herr_t take_scale_name(hid_t, unsigned, hid_t scale, void* result) {
  auto& name = *static_cast<std::string*>(result);
  name.assign(256, '\0');
  const ssize_t length = H5Iget_name(scale, name.data(), name.size());
  name.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
  name.erase(0, name.find_last_of('/') + 1);
  return 1;
}

StoredVariable describe_variable(const hdf5::Session& session, hid_t dataset, std::string name) {
  StoredVariable variable;
  variable.units = optional_text(session, dataset, "units");
  variable.long_name = optional_text(session, dataset, "long_name");
  for (const hsize_t entries : hdf5::extent_of(session, dataset)) {
    variable.extent.push_back(static_cast<std::size_t>(entries));
  }
  // A coordinate is its own dimension.
  const bool is_coordinate = H5DSis_scale(dataset) > 0;
  for (unsigned axis = 0; axis < variable.extent.size(); ++axis) {
    std::string dimension = is_coordinate ? name : std::string();
    if (!is_coordinate) {
      H5DSiterate_scales(dataset, axis, nullptr, take_scale_name, &dimension);
    }
    variable.dimensions.push_back(std::move(dimension));
  }
  variable.name = std::move(name);
  return variable;
}

}  // namespace

ResultsFile::ResultsFile(const std::filesystem::path& path) : session_(hdf5::Session::read(path)) {
  for (const std::string& name : hdf5::object_names(session_, session_.file())) {
    H5O_info_t info;
    session_.check(H5Oget_info_by_name(session_.file(), name.c_str(), &info, H5P_DEFAULT),
                   "look at an object");
    if (info.type != H5O_TYPE_DATASET) continue;
    const hdf5::Id dataset = hdf5::open_dataset(session_, session_.file(), name);
    if (is_numeric(session_, dataset)) {
      variables_.push_back(describe_variable(session_, dataset, name));
    }
  }
}

const StoredVariable* ResultsFile::find(std::string_view name) const {
  for (const StoredVariable& variable : variables_) {
    if (variable.name == name) return &variable;
  }
  return nullptr;
}

const StoredVariable& ResultsFile::require(std::string_view name) const {
  const StoredVariable* variable = find(name);
  if (variable == nullptr) {
    throw Error(ExitCode::file,
                fmt::format("{}: has no variable '{}'", session_.path().string(), name));
  }
  return *variable;
}

std::vector<double> ResultsFile::read(std::string_view name) const {
  const StoredVariable& variable = require(name);
  return read(name, std::vector<std::size_t>(variable.extent.size(), 0), variable.extent);
}

std::vector<double> ResultsFile::read(std::string_view name, std::span<const std::size_t> start,
                                      std::span<const std::size_t> count) const {
  const StoredVariable& variable = require(name);
  std::size_t total = 1;
  for (const std::size_t entries : count) total *= entries;
  std::vector<double> values(total);
  if (total == 0) return values;
  const hdf5::Id dataset = hdf5::open_dataset(session_, session_.file(), variable.name);
  const std::vector<hsize_t> from(start.begin(), start.end()), entries(count.begin(), count.end());
  hdf5::read_slab(session_, dataset, from, entries, H5T_NATIVE_DOUBLE, values.data());
  return values;
}

}  // namespace pileus::output

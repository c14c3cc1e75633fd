#include "scene/hdf5_reader.hpp"

#include <fmt/format.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>

#include "base/nearest_word.hpp"
#include "scene/problems.hpp"

namespace pileus::scene {
namespace {

/// An HDF5 identifier that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// HDF5 prints its error stack by itself; messages here are ours.
void silence_hdf5() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

/// Why a file that HDF5 refuses is refused.
[[noreturn]] void explain_refusal(const std::string& path) {
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw UnreadableFile(fmt::format("the data file '{}' cannot be opened: {}", path,
                                     std::strerror(errno != 0 ? errno : EIO)));
  std::array<char, 8> head{};
  stream.read(head.data(), head.size());
  static constexpr std::array<char, 8> signature = {'\x89', 'H',  'D',    'F',
                                                    '\r',   '\n', '\x1a', '\n'};
  if (stream.gcount() == 0) throw UnreadableFile(fmt::format("the data file '{}' is empty", path));
  if (head == signature)
    throw UnreadableFile(
        fmt::format("the data file '{}' is cut short or damaged; HDF5 cannot open "
                    "it",
                    path));
  if (head[0] == 'C' && head[1] == 'D' && head[2] == 'F')
    throw WrongContent(
        fmt::format("'{}' is a classic netCDF file; convert it with 'nccopy -k "
                    "netCDF-4'",
                    path));
  throw WrongContent(fmt::format("'{}' is neither a netCDF-4 nor an HDF5 file", path));
}

std::string read_text_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return {};
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute, type, &text) < 0 || text == nullptr) return {};
    std::string copy(text);
    H5free_memory(text);
    return copy;
  }
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, text.data()) < 0) return {};
  return text.c_str();  // without the padding
}

std::optional<double> read_number_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  double value = 0;
  if (H5Sget_simple_extent_npoints(space) != 1 || H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0)
    return std::nullopt;
  return value;
}

#if H5_VERSION_GE(1, 12, 0)
using ObjectInfo = H5O_info1_t;
#else
using ObjectInfo = H5O_info_t;
#endif

herr_t collect_name(hid_t, const char* name, const ObjectInfo* info, void* names) {
  if (info->type == H5O_TYPE_DATASET)
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

struct ScaleRequest {
  FileAxis axis;
};

herr_t read_scale(hid_t, unsigned, hid_t scale, void* data) {
  FileAxis& axis = static_cast<ScaleRequest*>(data)->axis;
  const ssize_t length = H5Iget_name(scale, nullptr, 0);
  if (length > 0) {
    axis.name.resize(static_cast<std::size_t>(length) + 1);
    H5Iget_name(scale, axis.name.data(), axis.name.size());
    axis.name.resize(static_cast<std::size_t>(length));
  }
  // netCDF writes dimensions without coordinates as scales that hold nothing.
  if (read_text_attribute(scale, "NAME").starts_with("This is a netCDF dimension")) return 1;
  const Handle space(H5Dget_space(scale), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  const Handle type(H5Dget_type(scale), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type);
  if (count < 1 || (kind != H5T_FLOAT && kind != H5T_INTEGER)) return 1;
  axis.points.resize(static_cast<std::size_t>(count));
  if (H5Dread(scale, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, axis.points.data()) < 0)
    axis.points.clear();
  axis.units = read_text_attribute(scale, "units");
  return 1;  // the first scale is the one
}

}  // namespace

Hdf5Reader::Hdf5Reader(const std::string& path) : path_(path) {
  silence_hdf5();
  file_ = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file_ < 0) explain_refusal(path);
}

Hdf5Reader::~Hdf5Reader() {
  if (dataset_ >= 0) H5Dclose(dataset_);
  if (file_ >= 0) H5Fclose(file_);
}

std::vector<std::string> Hdf5Reader::variable_names() const {
  std::vector<std::string> names;
  H5Ovisit2(file_, H5_INDEX_NAME, H5_ITER_INC, collect_name, &names, H5O_INFO_BASIC);
  return names;
}

void Hdf5Reader::open(const std::string& variable) {
  dataset_ = H5Dopen2(file_, variable.c_str(), H5P_DEFAULT);
  if (dataset_ < 0) {
    std::vector<std::string> names = variable_names();
    const std::string nearest = nearest_word(variable, names);
    if (names.size() > 12) names.resize(12);
    throw WrongContent(fmt::format("'{}' has no variable '{}'{}", path_, variable,
                                   !nearest.empty() ? fmt::format("; did you mean '{}'?", nearest)
                                   : names.empty()  ? std::string("; it holds none")
                                                    : "; it holds " + alternatives(names)));
  }
  const Handle type(H5Dget_type(dataset_), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type);
  if (kind != H5T_FLOAT && kind != H5T_INTEGER)
    throw WrongContent(fmt::format("the variable '{}' of '{}' is not numeric", variable, path_));
  const Handle space(H5Dget_space(dataset_), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  shape_.resize(static_cast<std::size_t>(std::max(0, rank)));
  H5Sget_simple_extent_dims(space, shape_.data(), nullptr);
}

std::vector<double> Hdf5Reader::last_record(std::size_t rank) const {
  const Handle space(H5Dget_space(dataset_), H5Sclose);
  std::vector<hsize_t> start(shape_.size(), 0), count = shape_;
  if (shape_.size() == rank + 1) {
    start[0] = shape_[0] - 1;
    count[0] = 1;
  }
  std::size_t total = 1;
  for (const hsize_t n : count) total *= n;
  const hsize_t flat = total;
  const Handle memory(H5Screate_simple(1, &flat, nullptr), H5Sclose);
  std::vector<double> values(total);
  if (H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) <
          0 ||
      H5Dread(dataset_, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()) < 0)
    throw UnreadableFile(fmt::format(
        "the data file '{}' is cut short or damaged; a variable cannot be read", path_));
  const auto missing = read_number_attribute(dataset_, "_FillValue");
  const double scale = read_number_attribute(dataset_, "scale_factor").value_or(1);
  const double offset = read_number_attribute(dataset_, "add_offset").value_or(0);
  for (double& value : values) {
    if (!std::isfinite(value) || (missing && value == *missing))
      throw WrongContent(fmt::format("'{}' has missing or infinite values", path_));
    value = value * scale + offset;
  }
  return values;
}

FileAxis Hdf5Reader::axis(std::size_t dimension) const {
  ScaleRequest request;
  const auto index = static_cast<unsigned>(dimension);
  if (H5DSget_num_scales(dataset_, index) > 0)
    H5DSiterate_scales(dataset_, index, nullptr, read_scale, &request);
  if (request.axis.points.size() != shape_[dimension]) request.axis.points.clear();
  return request.axis;
}

std::string Hdf5Reader::attribute(const char* name) const {
  return read_text_attribute(dataset_, name);
}

}  // namespace pileus::scene

#include "output/hdf5.hpp"

#include <fmt/format.h>

#include <type_traits>
#include <utility>

#include "output/hdf5_driver.hpp"
#include "output/seal.hpp"

namespace pileus::output::hdf5 {

namespace {

/// HDF5 reports its innermost cause first when walked upward.
herr_t keep_innermost(unsigned depth, const H5E_error2_t* entry, void* text) {
  if (depth == 0 && entry->desc != nullptr) *static_cast<std::string*>(text) = entry->desc;
  return 0;
}

std::string innermost_cause() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &text);
  H5Eclear2(H5E_DEFAULT);
  return text.empty() ? "HDF5 gives no reason" : text;
}

void silence_error_printing() {
  static const herr_t silenced = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  (void)silenced;
}

}  // namespace

Id::Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
Id& Id::operator=(Id&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, -1);
  }
  return *this;
}
void Id::reset() {
  if (id_ >= 0) H5Idec_ref(id_);
  id_ = -1;
}

// --- session -------------------------------------------------------------------------------------

Session::Session(const std::filesystem::path& path, StagedFile::Mode mode, H5F_libver_t newest) {
  silence_error_printing();
  staged_ = std::make_unique<StagedFile>(path, mode);
  const Id access(check(H5Pcreate(H5P_FILE_ACCESS), "prepare"));
  check(set_staged_driver(access, *staged_), "prepare");
  // 1.8 is the oldest format with ordered links and checksummed headers, and every netCDF reads it.
  check(H5Pset_libver_bounds(access, H5F_LIBVER_V18, newest), "prepare");
  check(H5Pset_file_locking(access, false, true), "prepare");
  check(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "prepare");
  if (mode == StagedFile::Mode::create) {
    const Id creation(check(H5Pcreate(H5P_FILE_CREATE), "prepare"));
    constexpr unsigned order = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
    check(H5Pset_link_creation_order(creation, order), "prepare");
    check(H5Pset_attr_creation_order(creation, order), "prepare");
    check(H5Pset_obj_track_times(creation, false), "prepare");
    file_ = Id(check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access), "create"));
  } else {
    const unsigned flags = mode == StagedFile::Mode::update ? H5F_ACC_RDWR : H5F_ACC_RDONLY;
    file_ = Id(check(H5Fopen(path.c_str(), flags, access), "open as HDF5"));
  }
}

Session Session::create(const std::filesystem::path& path) {
  return Session(path, StagedFile::Mode::create);
}
Session Session::create_with_references(const std::filesystem::path& path) {
  return Session(path, StagedFile::Mode::create, H5F_LIBVER_V110);
}
Session Session::update(const std::filesystem::path& path) {
  return Session(path, StagedFile::Mode::update);
}
Session Session::read(const std::filesystem::path& path) {
  return Session(path, StagedFile::Mode::read);
}

Session::~Session() {
  if (staged_) file_.reset();  // HDF5 flushes into the staged file, which then drops it
}

void Session::finish(bool durable, bool sealed) {
  const hid_t file = file_;
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "write");
  file_.reset();
  if (sealed) add_seal(*staged_);
  staged_->commit(durable);
}

void Session::fail(std::string_view operation) const {
  const std::string cause = innermost_cause();
  stop_if_write_failed();
  throw Error(ExitCode::file, fmt::format("{}: cannot {}: {}.", path().string(), operation, cause));
}

void Session::stop_if_write_failed() const {
  if (staged_->failure() != 0) throw file_error(path(), "write", staged_->failure());
}

// --- objects -------------------------------------------------------------------------------------

Id create_group(const Session& session, hid_t parent, const std::string& name) {
  const std::string operation = "create group " + name;
  const Id list(session.check(H5Pcreate(H5P_GROUP_CREATE), operation));
  constexpr unsigned order = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
  session.check(H5Pset_link_creation_order(list, order), operation);
  session.check(H5Pset_attr_creation_order(list, order), operation);
  session.check(H5Pset_obj_track_times(list, false), operation);
  return Id(
      session.check(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, list, H5P_DEFAULT), operation));
}

Id dataset_list(const Session& session) {
  Id list(session.check(H5Pcreate(H5P_DATASET_CREATE), "prepare"));
  session.check(H5Pset_attr_creation_order(list, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED),
                "prepare");
  session.check(H5Pset_obj_track_times(list, false), "prepare");
  return list;
}

Id create_dataset(const Session& session, hid_t parent, const std::string& name, hid_t type,
                  std::span<const hsize_t> extent, std::span<const hsize_t> maximum, hid_t list) {
  const std::string operation = "create variable " + name;
  const Id space(session.check(
      extent.empty() ? H5Screate(H5S_SCALAR)
                     : H5Screate_simple(static_cast<int>(extent.size()), extent.data(),
                                        maximum.empty() ? nullptr : maximum.data()),
      operation));
  return Id(session.check(
      H5Dcreate2(parent, name.c_str(), type, space, H5P_DEFAULT, list, H5P_DEFAULT), operation));
}

Id open_dataset(const Session& session, hid_t parent, const std::string& name) {
  return Id(session.check(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), "open variable " + name));
}

std::vector<hsize_t> extent_of(const Session& session, hid_t dataset) {
  const Id space(session.check(H5Dget_space(dataset), "read an extent"));
  const int rank = session.check(H5Sget_simple_extent_ndims(space), "read an extent");
  std::vector<hsize_t> extent(static_cast<std::size_t>(rank));
  session.check(H5Sget_simple_extent_dims(space, extent.data(), nullptr), "read an extent");
  return extent;
}

bool has_object(hid_t parent, const std::string& name) {
  return H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> object_names(const Session& session, hid_t parent) {
  H5G_info_t info;
  session.check(H5Gget_info(parent, &info), "list a group");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    auto get = [&](H5_index_t index, char* name, std::size_t room) {
      return H5Lget_name_by_idx(parent, ".", index, H5_ITER_INC, i, name, room, H5P_DEFAULT);
    };
    H5_index_t index = H5_INDEX_CRT_ORDER;
    ssize_t length = get(index, nullptr, 0);
    if (length < 0) length = get(index = H5_INDEX_NAME, nullptr, 0);
    session.check(length, "list a group");
    std::string name(static_cast<std::size_t>(length), '\0');
    session.check(get(index, name.data(), name.size() + 1), "list a group");
    names.push_back(std::move(name));
  }
  return names;
}

namespace {
/// Memory and file dataspaces of a hyperslab.
struct Selection {
  Id memory, file;
  Selection(const Session& session, hid_t dataset, std::span<const hsize_t> start,
            std::span<const hsize_t> count, const char* operation)
      : memory(session.check(
            H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), operation)),
        file(session.check(H5Dget_space(dataset), operation)) {
    session.check(
        H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
        operation);
  }
};
}  // namespace

void write_slab(const Session& session, hid_t dataset, std::span<const hsize_t> start,
                std::span<const hsize_t> count, hid_t memory_type, const void* data) {
  const Selection selection(session, dataset, start, count, "write");
  session.check(H5Dwrite(dataset, memory_type, selection.memory, selection.file, H5P_DEFAULT, data),
                "write");
  session.stop_if_write_failed();
}

void read_slab(const Session& session, hid_t dataset, std::span<const hsize_t> start,
               std::span<const hsize_t> count, hid_t memory_type, void* data) {
  const Selection selection(session, dataset, start, count, "read");
  session.check(H5Dread(dataset, memory_type, selection.memory, selection.file, H5P_DEFAULT, data),
                "read");
}

void write_array(const Session& session, hid_t parent, const std::string& name, hid_t file_type,
                 hid_t memory_type, const void* data, std::size_t count) {
  const hsize_t extent[] = {count};
  const Id dataset =
      create_dataset(session, parent, name, file_type, extent, {}, dataset_list(session));
  if (count > 0)
    session.check(H5Dwrite(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
                  "write " + name);
  session.stop_if_write_failed();
}

namespace {
std::size_t value_count(const Session& session, hid_t dataset) {
  std::size_t count = 1;
  for (const hsize_t n : extent_of(session, dataset)) count *= n;
  return count;
}

void read_all(const Session& session, hid_t dataset, const std::string& name, hid_t memory_type,
              void* data, std::size_t count) {
  if (count > 0)
    session.check(H5Dread(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
                  "read " + name);
}
}  // namespace

template <class T>
std::vector<T> read_array(const Session& session, hid_t parent, const std::string& name) {
  const hid_t type = std::is_same_v<T, double>          ? H5T_NATIVE_DOUBLE
                     : std::is_same_v<T, std::uint64_t> ? H5T_NATIVE_UINT64
                                                        : H5T_NATIVE_UINT8;
  const Id dataset = open_dataset(session, parent, name);
  const std::size_t count = value_count(session, dataset);
  // A damaged extent must not become an allocation of all memory; deflate gains at most 1032 : 1.
  if (count / 1032 > H5Dget_storage_size(dataset))
    throw Error(ExitCode::file, fmt::format("{}: {} claims {} values, more than the file can hold.",
                                            session.path().string(), name, count));
  std::vector<T> values(count);
  read_all(session, dataset, name, type, values.data(), values.size());
  return values;
}
template std::vector<double> read_array(const Session&, hid_t, const std::string&);
template std::vector<std::uint64_t> read_array(const Session&, hid_t, const std::string&);
template std::vector<std::uint8_t> read_array(const Session&, hid_t, const std::string&);

void read_array_into(const Session& session, hid_t parent, const std::string& name,
                     hid_t memory_type, void* data, std::size_t count) {
  const Id dataset = open_dataset(session, parent, name);
  if (value_count(session, dataset) != count)
    throw Error(ExitCode::file, fmt::format("{}: {} does not hold {} values.",
                                            session.path().string(), name, count));
  read_all(session, dataset, name, memory_type, data, count);
}

// --- text and attributes -------------------------------------------------------------------------

namespace {
Id text_type(const Session& session, std::size_t bytes) {
  Id type(session.check(H5Tcopy(H5T_C_S1), "prepare"));
  session.check(H5Tset_size(type, bytes), "prepare");
  session.check(H5Tset_cset(type, H5T_CSET_UTF8), "prepare");
  return type;
}
}  // namespace

void write_text(const Session& session, hid_t parent, const std::string& name,
                const std::string& text) {
  const Id type = text_type(session, H5T_VARIABLE);
  const Id dataset = create_dataset(session, parent, name, type, {}, {}, dataset_list(session));
  const char* pointer = text.c_str();
  session.check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &pointer), "write " + name);
}

std::string read_text(const Session& session, hid_t parent, const std::string& name) {
  const Id dataset = open_dataset(session, parent, name);
  const Id type = text_type(session, H5T_VARIABLE);
  const Id space(session.check(H5Dget_space(dataset), "read " + name));
  char* pointer = nullptr;
  session.check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &pointer), "read " + name);
  std::string text = pointer != nullptr ? pointer : "";
  H5Dvlen_reclaim(type, space, H5P_DEFAULT, &pointer);
  return text;
}

void write_attribute(const Session& session, hid_t object, const std::string& name,
                     const std::string& text) {
  const Id type = text_type(session, text.size() + 1);
  write_attribute(session, object, name, type, text.c_str());
}

void write_attribute(const Session& session, hid_t object, const std::string& name, hid_t type,
                     const void* value) {
  const std::string operation = "write attribute " + name;
  const Id space(session.check(H5Screate(H5S_SCALAR), operation));
  const Id attribute(session.check(
      H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), operation));
  session.check(H5Awrite(attribute, type, value), operation);
}

std::string read_text_attribute(const Session& session, hid_t object, const std::string& name) {
  const std::string operation = "read attribute " + name;
  const Id attribute(session.check(H5Aopen(object, name.c_str(), H5P_DEFAULT), operation));
  const Id type(session.check(H5Aget_type(attribute), operation));
  const std::size_t bytes = H5Tget_size(type);
  if (bytes == 0 || H5Tis_variable_str(type) > 0) session.fail(operation);
  std::string text(bytes, '\0');
  session.check(H5Aread(attribute, type, text.data()), operation);
  return text.substr(0, text.find('\0'));
}

void read_attribute(const Session& session, hid_t object, const std::string& name, hid_t type,
                    void* value) {
  const std::string operation = "read attribute " + name;
  const Id attribute(session.check(H5Aopen(object, name.c_str(), H5P_DEFAULT), operation));
  session.check(H5Aread(attribute, type, value), operation);
}

}  // namespace pileus::output::hdf5

// A thin layer over the HDF5 C API: handles that close themselves, calls that throw.
//
// HDF5's own error printing is off; its error stack goes into the message of the exception. File
// locking is off, so that a reader never stops the model (the run's lock file guards against two
// writers), and times of creation are not stored, so that equal runs give equal bytes.
#pragma once
#include <hdf5.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "output/staged_file.hpp"

namespace pileus::output::hdf5 {

/// An owned HDF5 identifier of any kind; −1 when empty.
class Id {
 public:
  Id() = default;
  explicit Id(hid_t id) : id_(id) {}
  ~Id() { reset(); }
  Id(Id&& other) noexcept;
  Id& operator=(Id&& other) noexcept;
  operator hid_t() const { return id_; }
  void reset();

 private:
  hid_t id_ = -1;
};

/// One opening of an HDF5 file. Changes reach the file at `commit`, all or none (StagedFile);
/// without it they are dropped. Every failure is an Error(ExitCode::file) naming the file, the
/// operation and the reason the system gives.
class Session {
 public:
  static Session create(const std::filesystem::path& path);
  /// As `create`, for a file that may have virtual variables, which refer to those of other files:
  /// HDF5 has them since 1.10.
  static Session create_with_references(const std::filesystem::path& path);
  static Session update(const std::filesystem::path& path);
  static Session read(const std::filesystem::path& path);
  ~Session();
  Session(Session&&) noexcept = default;

  hid_t file() const { return file_; }
  const std::filesystem::path& path() const { return staged_->path(); }
  void commit() { finish(false, false); }
  /// As `commit`; the file ends with a checksum (seal.hpp) and survives a power cut.
  void commit_sealed() { finish(true, true); }

  /// Passes a result of the C API on; throws when it is negative: "cannot <operation>".
  template <class Result>
  Result check(Result result, std::string_view operation) const {
    if (result < 0) fail(operation);
    return result;
  }
  [[noreturn]] void fail(std::string_view operation) const;
  /// Throws as soon as a write was refused, before more work is put into a lost file.
  void stop_if_write_failed() const;

 private:
  Session(const std::filesystem::path& path, StagedFile::Mode mode,
          H5F_libver_t newest = H5F_LIBVER_V18);
  void finish(bool durable, bool sealed);
  std::unique_ptr<StagedFile> staged_;
  Id file_;
};

// --- objects; `parent` is a file or group, names are relative to it -----------------------------

/// A group that keeps the order of creation, as netCDF-4 needs it.
Id create_group(const Session& session, hid_t parent, const std::string& name);
/// A dataset-creation list with attribute order kept and no times.
Id dataset_list(const Session& session);
Id create_dataset(const Session& session, hid_t parent, const std::string& name, hid_t type,
                  std::span<const hsize_t> extent, std::span<const hsize_t> maximum, hid_t list);
Id open_dataset(const Session& session, hid_t parent, const std::string& name);
std::vector<hsize_t> extent_of(const Session& session, hid_t dataset);
bool has_object(hid_t parent, const std::string& name);
/// Names of the links of a group, in order of creation where the file keeps it, else by name.
std::vector<std::string> object_names(const Session& session, hid_t parent);

/// Writes or reads a hyperslab from or to contiguous memory of `memory_type`.
void write_slab(const Session& session, hid_t dataset, std::span<const hsize_t> start,
                std::span<const hsize_t> count, hid_t memory_type, const void* data);
void read_slab(const Session& session, hid_t dataset, std::span<const hsize_t> start,
               std::span<const hsize_t> count, hid_t memory_type, void* data);

/// A one-dimensional contiguous array, written and read whole.
void write_array(const Session& session, hid_t parent, const std::string& name, hid_t file_type,
                 hid_t memory_type, const void* data, std::size_t count);
/// All values of a variable, slowest axis first; T is double, std::uint64_t or std::uint8_t.
template <class T>
std::vector<T> read_array(const Session& session, hid_t parent, const std::string& name);
/// As above into memory with room for exactly `count` values; throws when there are more or fewer.
void read_array_into(const Session& session, hid_t parent, const std::string& name,
                     hid_t memory_type, void* data, std::size_t count);

/// Text: as a scalar string variable, and as an attribute (fixed length, UTF-8).
void write_text(const Session& session, hid_t parent, const std::string& name,
                const std::string& text);
std::string read_text(const Session& session, hid_t parent, const std::string& name);
void write_attribute(const Session& session, hid_t object, const std::string& name,
                     const std::string& text);
/// A scalar attribute of a numerical `type` (used both in the file and in memory).
void write_attribute(const Session& session, hid_t object, const std::string& name, hid_t type,
                     const void* value);
std::string read_text_attribute(const Session& session, hid_t object, const std::string& name);
void read_attribute(const Session& session, hid_t object, const std::string& name, hid_t type,
                    void* value);

}  // namespace pileus::output::hdf5

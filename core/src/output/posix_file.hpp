// System calls on files, with errors that name the file, the operation and the system's reason.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.hpp"

namespace pileus::output {

/// "path: cannot <operation>: <reason of errno>." as an Error with ExitCode::file.
Error file_error(const std::filesystem::path& path, std::string_view operation, int error_number);

/// An owned file descriptor; −1 when empty.
class Descriptor {
 public:
  Descriptor() = default;
  /// open(2) with close-on-exec; throws `file_error` with `operation`.
  Descriptor(const std::filesystem::path& path, int flags, std::string_view operation);
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  int get() const { return descriptor_; }
  explicit operator bool() const { return descriptor_ >= 0; }
  void reset();

 private:
  int descriptor_ = -1;
};

/// Reads up to `bytes` at `offset`, through interruptions and short reads; returns the number read
/// (short only at the end of the file) or −1 with errno set.
std::int64_t read_fully(int descriptor, void* buffer, std::size_t bytes, std::uint64_t offset);

/// Writes all `bytes` at `offset`; false with errno set when the system refuses. A file-size limit
/// (RLIMIT_FSIZE) gives EFBIG instead of killing the process.
bool write_fully(int descriptor, const void* buffer, std::size_t bytes, std::uint64_t offset);

/// Makes a rename or unlink in `directory` survive a power cut. File systems that cannot sync a
/// directory are tolerated.
void sync_directory(const std::filesystem::path& directory);

/// Replaces `path` by `text`: written aside, renamed. A reader sees the old or the new
/// text, never a part of one; when this throws, the old file is untouched.
/// `durable` makes the new text survive a power cut.
void replace_file(const std::filesystem::path& path, std::string_view text, bool durable = true);

/// The whole file; throws `file_error`.
std::string read_text_file(const std::filesystem::path& path);

}  // namespace pileus::output

#include "output/posix_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace pileus::output {

Error file_error(const std::filesystem::path& path, std::string_view operation, int error_number) {
  return Error(ExitCode::file, fmt::format("{}: cannot {}: {}.", path.string(), operation,
                                           std::generic_category().message(error_number)));
}

Descriptor::Descriptor(const std::filesystem::path& path, int flags, std::string_view operation)
    : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw file_error(path, operation, errno);
}
Descriptor::~Descriptor() {
  reset();
}
Descriptor::Descriptor(Descriptor&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}
Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    reset();
    descriptor_ = std::exchange(other.descriptor_, -1);
  }
  return *this;
}
void Descriptor::reset() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

std::int64_t read_fully(int descriptor, void* buffer, std::size_t bytes, std::uint64_t offset) {
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t count = ::pread(descriptor, static_cast<char*>(buffer) + done, bytes - done,
                                  static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return -1;
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  return static_cast<std::int64_t>(done);
}

namespace {
/// SIGXFSZ would end the process where write(2) can say EFBIG instead.
void ignore_file_size_signal() {
  static const bool ignored = [] {
    struct sigaction current {};
    if (sigaction(SIGXFSZ, nullptr, &current) == 0 && current.sa_handler == SIG_DFL)
      signal(SIGXFSZ, SIG_IGN);
    return true;
  }();
  (void)ignored;
}
}  // namespace

bool write_fully(int descriptor, const void* buffer, std::size_t bytes, std::uint64_t offset) {
  ignore_file_size_signal();
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t count = ::pwrite(descriptor, static_cast<const char*>(buffer) + done,
                                   bytes - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    if (count == 0) {
      errno = ENOSPC;
      return false;
    }
    done += static_cast<std::size_t>(count);
  }
  return true;
}

void sync_directory(const std::filesystem::path& directory) {
  const std::filesystem::path name = directory.empty() ? "." : directory;
  const Descriptor handle(name, O_RDONLY | O_DIRECTORY, "open the folder");
  if (::fsync(handle.get()) != 0 && errno != EINVAL && errno != ENOTSUP)
    throw file_error(name, "sync the folder", errno);
}

void replace_file(const std::filesystem::path& path, std::string_view text, bool durable) {
  std::filesystem::path aside = path;
  aside += ".tmp";
  try {
    const Descriptor file(aside, O_WRONLY | O_CREAT | O_TRUNC, "write");
    if (!write_fully(file.get(), text.data(), text.size(), 0) ||
        (durable && ::fsync(file.get()) != 0))
      throw file_error(path, "write", errno);
    if (::rename(aside.c_str(), path.c_str()) != 0) throw file_error(path, "replace", errno);
  } catch (...) {
    ::unlink(aside.c_str());
    throw;
  }
  if (durable) sync_directory(path.parent_path());
}

std::string read_text_file(const std::filesystem::path& path) {
  const Descriptor file(path, O_RDONLY, "read");
  std::string text;
  // Until nothing more comes: files of /proc state a size of zero.
  for (std::size_t piece = 4096;; piece *= 2) {
    const std::size_t before = text.size();
    text.resize(before + piece);
    const std::int64_t count = read_fully(file.get(), text.data() + before, piece, before);
    if (count < 0) throw file_error(path, "read", errno);
    text.resize(before + static_cast<std::size_t>(count));
    if (static_cast<std::size_t>(count) < piece) return text;
  }
}

}  // namespace pileus::output

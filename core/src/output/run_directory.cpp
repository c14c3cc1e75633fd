#include "output/run_directory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "base/log.hpp"
#include "output/posix_file.hpp"

namespace pileus::output {

namespace {

constexpr const char* lock_name = "run.lock";

/// Files of a run: by whole name, or by suffix. Checked against what the writers of this folder
/// use.
bool is_run_file(const std::string& name) {
  constexpr std::array<std::string_view, 3> names = {"summary.json", "status.json", "plan.json"};
  constexpr std::array<std::string_view, 6> stems = {"fields", "parcels", "profiles",
                                                     "series", "spectra", "droplets"};
  constexpr std::array<std::string_view, 4> endings = {".nc", ".nc.journal", ".nc.tmp", ".xmf"};
  for (const std::string_view known : names)
    if (name == known || name == std::string(known) + ".tmp") return true;
  for (const std::string_view stem : stems)
    for (const std::string_view ending : endings)
      if (name == std::string(stem) + std::string(ending)) return true;
  return (name.starts_with("checkpoint_") || name.starts_with("failure")) &&
         (name.ends_with(".h5") || name.ends_with(".h5.tmp"));
}

std::vector<std::filesystem::path> run_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (is_run_file(entry.path().filename().string())) files.push_back(entry.path());
  return files;
}

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// Start of a process in clock ticks since boot (field 22 of /proc/<pid>/stat), which tells a
/// process from a later one of the same number; "-" when there is no such process.
std::string process_start(long pid) {
  try {
    const std::string stat = read_text_file(fmt::format("/proc/{}/stat", pid));
    std::istringstream fields(stat.substr(stat.rfind(')') + 1));
    std::string field;
    for (int number = 3; number <= 22; ++number) fields >> field;
    if (!field.empty()) return field;
  } catch (const Error&) {
    // No such process, or a system without /proc.
  }
  return "-";
}

struct LockHolder {
  long pid = 0;
  std::string start, host;
  bool complete = false;

  static LockHolder self() { return {getpid(), process_start(getpid()), host_name(), true}; }
  static LockHolder parse(const std::string& text) {
    LockHolder holder;
    std::istringstream in(text);
    in >> holder.pid >> holder.start >> holder.host;
    holder.complete = text.ends_with('\n');
    return holder;
  }
  std::string text() const { return fmt::format("{} {} {}\n", pid, start, host); }
  bool is_gone() const {
    // Without its end: its writer died while filling it, for it held the guard meanwhile.
    if (!complete) return true;
    if (host != host_name() || pid <= 0) return false;
    if (kill(static_cast<pid_t>(pid), 0) != 0 && errno == ESRCH) return true;
    const std::string now = process_start(pid);
    return now != "-" && now != start;
  }
};

/// Serialises the look at a lock and its replacement. Where the file system has no flock, two
/// processes taking over the same dead lock in the same instant remain possible.
class FolderGuard {
 public:
  explicit FolderGuard(const std::filesystem::path& folder)
      : handle_(folder, O_RDONLY | O_DIRECTORY, "open the folder") {
    while (flock(handle_.get(), LOCK_EX) != 0 && errno == EINTR) {
    }
  }

 private:
  Descriptor handle_;
};

/// Writes the lock with one system call after O_EXCL, or says that it exists.
bool create_lock(const std::filesystem::path& lock, const std::string& text) {
  const int descriptor = ::open(lock.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0 && errno == EEXIST) return false;
  if (descriptor < 0) throw file_error(lock, "create the lock file", errno);
  const bool written = write_fully(descriptor, text.data(), text.size(), 0);
  const int reason = errno;
  ::close(descriptor);
  if (!written) {
    ::unlink(lock.c_str());
    throw file_error(lock, "write the lock file", reason);
  }
  return true;
}

std::string in_use_by(const LockHolder& holder, const std::filesystem::path& folder) {
  return fmt::format(
      "{}: the folder is in use by process {} on {}. If that process no longer exists, delete {}.",
      folder.string(), holder.pid, holder.host.empty() ? "an unknown host" : holder.host,
      (folder / lock_name).string());
}

void take_lock(const std::filesystem::path& folder, const std::string& text) {
  const std::filesystem::path lock = folder / lock_name;
  const FolderGuard guard(folder);
  if (create_lock(lock, text)) return;
  const LockHolder holder = LockHolder::parse(read_text_file(lock));
  if (!holder.is_gone()) throw Error(ExitCode::file, in_use_by(holder, folder));
  log(LogLevel::info, fmt::format("{}: taking over the lock of process {}, which is gone.",
                                  folder.string(), holder.pid));
  ::unlink(lock.c_str());
  if (!create_lock(lock, text))
    throw Error(ExitCode::file, fmt::format("{}: another process took the folder in this moment.",
                                            folder.string()));
}

}  // namespace

std::string reason_in_use(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder / lock_name, error)) return {};
  try {
    const FolderGuard guard(folder);  // a lock is complete when its writer lets go of it
    const LockHolder holder = LockHolder::parse(read_text_file(folder / lock_name));
    return holder.is_gone() ? std::string() : in_use_by(holder, folder);
  } catch (const Error&) {
    return {};  // it was given back in this moment
  }
}

bool holds_run(const std::filesystem::path& folder) {
  return !run_files(folder).empty();
}

RunDirectory::RunDirectory(std::filesystem::path folder, Mode mode) : folder_(std::move(folder)) {
  std::error_code error;
  created_ = std::filesystem::create_directories(folder_, error);
  if (error || !std::filesystem::is_directory(folder_))
    throw file_error(folder_, "create the folder", error ? error.value() : ENOTDIR);
  const std::string text = LockHolder::self().text();
  try {
    take_lock(folder_, text);
    lock_text_ = text;
    if (mode == Mode::fresh && holds_run(folder_))
      throw Error(ExitCode::file,
                  fmt::format("{}: the folder holds a run. Continue it with --resume, replace it "
                              "with --force, or choose another folder with --out.",
                              folder_.string()));
  } catch (...) {
    release();
    throw;
  }
}

RunDirectory::~RunDirectory() {
  release();
}

void RunDirectory::release() noexcept {
  const std::filesystem::path lock = folder_ / lock_name;
  try {
    if (!lock_text_.empty() && read_text_file(lock) == lock_text_) ::unlink(lock.c_str());
  } catch (const Error&) {
    // Somebody removed the lock or the folder: nothing is left to give back.
  }
  if (created_) ::rmdir(folder_.c_str());  // refuses a folder that holds anything
}

void RunDirectory::remove_previous_run() const {
  for (const std::filesystem::path& file : run_files(folder_))
    if (::unlink(file.c_str()) != 0 && errno != ENOENT)
      throw file_error(file, "remove the file of the earlier run", errno);
}

}  // namespace pileus::output

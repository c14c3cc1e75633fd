#include "conform/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>

#include "base/error.hpp"
#include "host/breadcrumb.hpp"

namespace pileus::conform {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int did_not_return = 120;  // an exit code that no ended plugin has

struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
      throw Error(ExitCode::file, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) ::close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_end(int which) {
    ::close(ends[static_cast<std::size_t>(which)]);
    ends[static_cast<std::size_t>(which)] = -1;
  }
};

void write_all(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(file, text.data() + done, text.size() - done);
    if (written <= 0) return;
    done += static_cast<std::size_t>(written);
  }
}

[[noreturn]] void become_child(const std::function<std::string()>& work, int result, int words,
                               pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(did_not_return);
  ::setpgid(0, 0);  // so that what it starts ends with it
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::dup2(words, STDOUT_FILENO);
  ::dup2(words, STDERR_FILENO);
  host::install_crash_handler();
  try {
    write_all(result, work());
  } catch (const std::exception& error) {
    write_all(words, error.what());
    ::_exit(did_not_return);
  } catch (...) {
    ::_exit(did_not_return);
  }
  ::_exit(0);
}

/// The processor time a process has used so far, s; 0 if it cannot be known.
double processor_time(pid_t process) {
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(process, &clock) != 0 || ::clock_gettime(clock, &used) != 0) return 0;
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

/// When a child has had its time. Processor time is what counts, so that a busy machine fails
/// nobody; one that waits without using any is given up after `patience` times as long.
class TimeLimit {
 public:
  TimeLimit(pid_t child, double seconds) : child_(child), seconds_(seconds) {}

  bool is_over() {
    if (const double used = processor_time(child_); used >= seconds_) {
      words_ = fmt::format("took longer than {:g} s of processor time", seconds_);
    } else if (std::chrono::duration<double>(Clock::now() - begin_).count() >=
               patience * seconds_) {
      words_ = fmt::format("took longer than {:g} s", patience * seconds_);
    }
    return !words_.empty();
  }
  /// Which limit was passed; empty: none.
  const std::string& words() const { return words_; }
  static constexpr std::chrono::milliseconds interval{50};  // between two looks

 private:
  static constexpr double patience = 10;
  pid_t child_;
  double seconds_;
  Clock::time_point begin_ = Clock::now();
  std::string words_;
};

/// Reads both pipes until the child closes them or its time is over.
void collect(Pipe& result, Pipe& words, TimeLimit& limit, ChildResult& into) {
  std::array<pollfd, 2> files{{{result.ends[0], POLLIN, 0}, {words.ends[0], POLLIN, 0}}};
  std::array<char, 4096> buffer{};
  while ((files[0].fd >= 0 || files[1].fd >= 0) && !limit.is_over()) {
    if (::poll(files.data(), files.size(), static_cast<int>(TimeLimit::interval.count())) < 0)
      continue;  // a signal
    for (std::size_t k = 0; k < files.size(); ++k) {
      if (files[k].fd < 0 || (files[k].revents & (POLLIN | POLLHUP | POLLERR)) == 0) continue;
      const ssize_t got = ::read(files[k].fd, buffer.data(), buffer.size());
      std::string& text = k == 0 ? into.text : into.words;
      if (got > 0) text.append(buffer.data(), static_cast<std::size_t>(got));
      if (got <= 0) files[k].fd = -1;
    }
  }
}

std::string describe_end(int status, const std::string& words) {
  const std::size_t fatal = words.find("pileus: fatal: ");
  const std::string crumb =
      fatal == std::string::npos
          ? ""
          : ": " + words.substr(fatal + 15, words.find('\n', fatal) - fatal - 15);
  if (WIFSIGNALED(status))
    return fmt::format("crashed with signal {} ({}){}", WTERMSIG(status),
                       ::strsignal(WTERMSIG(status)), crumb);
  return fmt::format("ended with exit code {}{}", WEXITSTATUS(status), crumb);
}

}  // namespace

ChildResult run_in_child(const std::function<std::string()>& work, double seconds) {
  Pipe result, words;
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0)
    throw Error(ExitCode::file, fmt::format("cannot start a process: {}", std::strerror(errno)));
  if (child == 0) become_child(work, result.ends[1], words.ends[1], parent);
  result.close_end(1);
  words.close_end(1);
  TimeLimit limit(child, seconds);
  ChildResult found;
  collect(result, words, limit, found);
  const bool in_time = limit.words().empty();
  ::kill(-child, SIGKILL);  // whatever is left of it
  if (!in_time) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  found.finished = in_time && WIFEXITED(status) && WEXITSTATUS(status) == 0 && !found.text.empty();
  if (!found.finished) found.end = in_time ? describe_end(status, found.words) : limit.words();
  return found;
}

}  // namespace pileus::conform

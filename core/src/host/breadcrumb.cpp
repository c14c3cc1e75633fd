#include "host/breadcrumb.hpp"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "base/error.hpp"

namespace pileus::host {
namespace {

thread_local constinit Breadcrumb current{};

constexpr std::array<int, 5> fatal_signals = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr std::array<const char*, 5> signal_names = {"SIGSEGV", "SIGBUS", "SIGFPE", "SIGILL",
                                                     "SIGABRT"};
std::array<struct sigaction, 5> previous_actions{};
bool installed = false;

/// A stack of its own for the handler, so that a plugin that overflows its stack is still named.
class HandlerStack {
 public:
  HandlerStack() {
    memory_ = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    stack_t present{};
    // Somebody else's handler stack (a sanitizer's) is as good as ours.
    if (memory_ == MAP_FAILED || ::sigaltstack(nullptr, &present) != 0 ||
        (present.ss_flags & SS_DISABLE) == 0) {
      return;
    }
    stack_t mine{};
    mine.ss_sp = memory_;
    mine.ss_size = bytes;
    in_use_ = ::sigaltstack(&mine, nullptr) == 0;
  }
  ~HandlerStack() {
    if (in_use_) {
      stack_t none{};
      none.ss_flags = SS_DISABLE;
      ::sigaltstack(&none, nullptr);
    }
    if (memory_ != MAP_FAILED) ::munmap(memory_, bytes);
  }
  HandlerStack(const HandlerStack&) = delete;
  HandlerStack& operator=(const HandlerStack&) = delete;

 private:
  static constexpr std::size_t bytes = 65536;
  void* memory_ = MAP_FAILED;
  bool in_use_ = false;
};

/// A line built without allocation or locks: all that a signal handler may do.
class Line {
 public:
  Line& operator<<(const char* text) {
    while (text != nullptr && *text != '\0' && length_ < sizeof text_ - 1) {
      text_[length_++] = *text++;
    }
    return *this;
  }
  Line& operator<<(std::uint64_t number) {
    char digits[24];
    std::size_t at = sizeof digits;
    digits[--at] = '\0';
    do {
      digits[--at] = static_cast<char>('0' + number % 10);
      number /= 10;
    } while (number != 0);
    return *this << &digits[at];
  }
  void write_out() {
    text_[length_++] = '\n';
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text_, length_);
  }

 private:
  char text_[1024];
  std::size_t length_ = 0;
};

void name_plugin(Line& line) {
  line << " in plugin ";
  if (current.operator_id != nullptr) line << current.operator_id << ", ";
  line << "phase " << current.phase;
  if (current.block >= 0) {
    line << ", step " << current.step << ", block " << static_cast<std::uint64_t>(current.block);
  }
  line << " (library " << current.library << ")";
}

void on_fatal_signal(int number) {
  std::size_t which = 0;
  while (which + 1 < fatal_signals.size() && fatal_signals[which] != number) ++which;
  Line line;
  line << "pileus: fatal: " << signal_names[which];
  if (current.phase == nullptr) {
    line << " outside any plugin";
  } else {
    name_plugin(line);
  }
  line.write_out();
  ::sigaction(number, &previous_actions[which], nullptr);
  ::raise(number);
}

/// Scientific code of old ends the program where it knows no further (Fortran's STOP); that must
/// not look like the end of a run.
void on_exit() {
  if (current.phase == nullptr) return;
  Line line;
  line << "pileus: fatal: the program was ended";
  name_plugin(line);
  line.write_out();
  ::_exit(static_cast<int>(ExitCode::plugin));
}

}  // namespace

Breadcrumb current_breadcrumb() {
  return current;
}

BreadcrumbScope::BreadcrumbScope(const Breadcrumb& crumb) : outer_(current) {
  if (installed) {
    thread_local const HandlerStack stack;
    static_cast<void>(&stack);
  }
  current = crumb;
}

BreadcrumbScope::~BreadcrumbScope() {
  current = outer_;
}

void install_crash_handler() {
  if (installed) return;
  struct sigaction action {};
  action.sa_handler = on_fatal_signal;
  action.sa_flags = SA_ONSTACK | SA_NODEFER;
  ::sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < fatal_signals.size(); ++i) {
    ::sigaction(fatal_signals[i], &action, &previous_actions[i]);
  }
  std::atexit(on_exit);
  installed = true;
}

}  // namespace pileus::host

#include "fault_injection.hpp"

#include <dlfcn.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace pileus::output {

namespace {

Fault armed = Fault::none;
int fault_at = 0, calls = 0;

enum class Call { write, other };

/// Whether this call has to fail; errno is set then.
bool fails(Call call, const std::function<void()>& half) {
  ++calls;
  if (armed == Fault::kill && calls == fault_at) {
    half();
    kill(getpid(), SIGKILL);
  }
  if (armed == Fault::no_space && calls >= fault_at && call == Call::write) {
    errno = ENOSPC;
    return true;
  }
  return false;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

void inject_fault(Fault fault, int n) {
  armed = fault;
  fault_at = n;
  calls = 0;
}

int counted_calls() {
  return calls;
}

bool dies_at(int n, const std::function<void()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    inject_fault(Fault::kill, n);
    body();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
}

}  // namespace pileus::output

using pileus::output::Call;
using pileus::output::fails;
using pileus::output::next;

extern "C" {
ssize_t pwrite(int file, const void* data, size_t bytes, off_t offset) {
  static auto* const real = next<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  if (fails(Call::write, [&] { real(file, data, bytes / 2, offset); })) return -1;
  return real(file, data, bytes, offset);
}
int ftruncate(int file, off_t size) noexcept {
  static auto* const real = next<int(int, off_t)>("ftruncate");
  fails(Call::other, [] {});
  return real(file, size);
}
int fsync(int file) {
  static auto* const real = next<int(int)>("fsync");
  fails(Call::other, [] {});
  return real(file);
}
int rename(const char* from, const char* to) noexcept {
  static auto* const real = next<int(const char*, const char*)>("rename");
  fails(Call::other, [] {});
  return real(from, to);
}
int unlink(const char* path) noexcept {
  static auto* const real = next<int(const char*)>("unlink");
  fails(Call::other, [] {});
  return real(path);
}
}

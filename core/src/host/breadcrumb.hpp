// Where each thread is inside plugin code, so that a crash names the operator.
#pragma once
#include <cstdint>

namespace pileus::host {

/// What the current thread is calling. The texts live as long as the library, which is never
/// unloaded.
struct Breadcrumb {
  const char* library = nullptr;
  const char* operator_id = nullptr;  // null while the library is loaded
  const char* phase = nullptr;        // null outside plugin code
  std::uint64_t step = 0;
  std::int64_t block = -1;  // −1: not a call on a block
};

/// The crumb of this thread, for threads that work on its behalf.
Breadcrumb current_breadcrumb();

/// Lays a crumb for the time of a call.
class BreadcrumbScope {
 public:
  explicit BreadcrumbScope(const Breadcrumb& crumb);
  ~BreadcrumbScope();
  BreadcrumbScope(const BreadcrumbScope&) = delete;
  BreadcrumbScope& operator=(const BreadcrumbScope&) = delete;

 private:
  Breadcrumb outer_;
};

/// Installs a handler for SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT that prints the crumb of the
/// thread concerned on standard error and raises the signal again under the action that was there
/// before, so that a core dump or a sanitizer's report still comes. A plugin that calls exit() is
/// named too, and the exit code is then that of a failed plugin. Calling it again does nothing.
void install_crash_handler();

}  // namespace pileus::host

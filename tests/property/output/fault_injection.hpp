// Dies or fails at the n-th change of a file: the test program's own pwrite and friends, which the
// linker prefers to those of the C library.
#pragma once
#include <functional>

namespace pileus::output {

enum class Fault {
  none,
  kill,      // SIGKILL in the middle of the call: of a write, half reaches the file
  no_space,  // the call and all later ones that need space fail with ENOSPC
};

/// Lets the `n`-th call (from 1) of pwrite, ftruncate, rename, unlink and fsync fall into `fault`.
void inject_fault(Fault fault, int n);
/// Calls counted since `inject_fault`.
int counted_calls();

/// Runs `body` in a child process that is to die at call `n`; false when it ended before.
bool dies_at(int n, const std::function<void()>& body);

}  // namespace pileus::output

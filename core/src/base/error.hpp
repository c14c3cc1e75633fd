// What a failure is, and the exit code it ends the program with.
#pragma once
#include <stdexcept>
#include <string>

namespace pileus {

/// Exit codes of the program; part of its documented interface.
enum class ExitCode : int {
  done = 0,
  usage = 2,      // scene or command line wrong
  plugin = 3,     // a plugin was refused or failed
  numerical = 4,  // the solution broke down; a failure bundle was written
  file = 5,       // a file or the disk
  stopped = 75,   // stopped on request with a checkpoint: resume me
};

/// A failure the user can act on: one or more complete sentences, without a trailing newline.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

}  // namespace pileus

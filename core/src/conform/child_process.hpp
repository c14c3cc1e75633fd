// Work in a process of its own: a crash or a loop without end is its result, not our end.
#pragma once
#include <functional>
#include <string>

namespace pileus::conform {

struct ChildResult {
  bool finished = false;  // the work returned; `text` is what it returned
  std::string text;
  std::string end;    // otherwise how it ended: "crashed with signal 11", "took longer than 20 s"
  std::string words;  // what it wrote on standard error, its end
};

/// Runs `work` in a copy of this process, for at most `seconds` of processor time and ten times as
/// many of waiting. What the copy prints is caught. To be called before this process has started
/// threads: a copy has only the one.
/// Errors  Error(ExitCode::file) if no process can be started
ChildResult run_in_child(const std::function<std::string()>& work, double seconds);

}  // namespace pileus::conform

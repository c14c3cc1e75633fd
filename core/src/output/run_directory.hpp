// The folder a run writes to, held by one process at a time.
#pragma once
#include <filesystem>
#include <string>

namespace pileus::output {

/// Holds `run.lock` in the folder of a run from construction to destruction.
class RunDirectory {
 public:
  enum class Mode {
    fresh,   // refuse a folder that holds a run
    force,   // accept it; its files go when `remove_previous_run` is called
    resume,  // accept it and continue
  };

  /// Creates the folder where needed and takes the lock. A lock left by a process of this host that
  /// no longer lives is taken over. Throws Error(ExitCode::file): the folder cannot be created or
  /// written, another process holds it (named), or it holds a run and `mode` is fresh. Changes
  /// nothing that existed.
  RunDirectory(std::filesystem::path folder, Mode mode);
  /// Gives the lock back, and removes the folder again if this object created it and it is empty.
  ~RunDirectory();
  RunDirectory(const RunDirectory&) = delete;
  RunDirectory& operator=(const RunDirectory&) = delete;

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

  /// Removes the files an earlier run left here: results, sidecars, journals, checkpoints, summary,
  /// status, and failure*.h5. Files of other names stay. To be called once the new run is known to
  /// be valid.
  void remove_previous_run() const;

 private:
  void release() noexcept;

  std::filesystem::path folder_;
  bool created_ = false;
  std::string lock_text_;
};

/// Why the folder cannot be taken: another process, named, holds it. Empty where none does, or one
/// of this host that no longer lives. Changes nothing; to be asked before anything in a folder is
/// touched that is then handed to a process which takes it.
std::string reason_in_use(const std::filesystem::path& folder);

/// Whether the folder holds files of a run.
bool holds_run(const std::filesystem::path& folder);

}  // namespace pileus::output

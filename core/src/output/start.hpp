// What to do about a file of the same name that is already there.
#pragma once
#include <filesystem>
#include <span>

namespace pileus::output {

struct Start {
  enum class Kind {
    fresh,      // refuse: it belongs to another run
    overwrite,  // replaced when the first record is written, not before
    resume,     // kept up to and including `time`, later records removed
  };
  Kind kind = Kind::fresh;
  double time = 0;  // s

  static Start fresh() { return {}; }
  static Start overwrite() { return {Kind::overwrite, 0}; }
  static Start resume_at(double time) { return {Kind::resume, time}; }
};

/// Throws Error(ExitCode::file) when `start` is fresh and the file exists.
void refuse_existing(const std::filesystem::path& path, const Start& start);

/// Throws std::invalid_argument unless `added` continues the ascending `times`.
void require_later(const std::filesystem::path& path, std::span<const double> times,
                   std::span<const double> added);

}  // namespace pileus::output

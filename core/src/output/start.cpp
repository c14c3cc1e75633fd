#include "output/start.hpp"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>

#include "base/error.hpp"

namespace pileus::output {

void refuse_existing(const std::filesystem::path& path, const Start& start) {
  if (start.kind == Start::Kind::fresh && std::filesystem::exists(path))
    throw Error(ExitCode::file,
                fmt::format("{}: the file exists and belongs to another run. Choose another "
                            "folder with --out, continue that run with --resume, or replace it "
                            "with --force.",
                            path.string()));
}

void require_later(const std::filesystem::path& path, std::span<const double> times,
                   std::span<const double> added) {
  double last = times.empty() ? -std::numeric_limits<double>::infinity() : times.back();
  for (const double time : added) {
    if (!(time > last))
      throw std::invalid_argument(
          fmt::format("{}: a record at {} s cannot follow one at {} s", path.string(), time, last));
    last = time;
  }
}

}  // namespace pileus::output

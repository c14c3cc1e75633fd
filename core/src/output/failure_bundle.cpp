#include "output/failure_bundle.hpp"

#include <fmt/format.h>

#include "output/seal.hpp"

namespace pileus::output {

namespace {
constexpr const char* format_name = "pileus failure bundle 1";
}

void write_failure_bundle(const std::filesystem::path& path, const NamedData& data) {
  hdf5::Session session = hdf5::Session::create(path);
  hdf5::write_attribute(session, session.file(), "format", format_name);
  write_named_data(session, data);
  session.commit_sealed();
}

NamedData read_failure_bundle(const std::filesystem::path& path) {
  require_seal(path);
  const hdf5::Session session = hdf5::Session::read(path);
  if (hdf5::read_text_attribute(session, session.file(), "format") != format_name)
    throw Error(ExitCode::file, fmt::format("{}: not a failure bundle.", path.string()));
  return read_named_data(session);
}

}  // namespace pileus::output

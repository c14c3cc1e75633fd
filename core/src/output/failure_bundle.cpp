#include "output/failure_bundle.hpp"

#include <fmt/format.h>

namespace pileus::output {

namespace {
constexpr const char* format_name = "pileus failure bundle 1";
}

void write_failure_bundle(const std::filesystem::path& path, const NamedData& data) {
  hdf5::Session session = hdf5::Session::create(path);
  PayloadDigest digest;
  hdf5::write_attribute(session, session.file(), "format", format_name);
  write_named_data(session, data, digest);
  hdf5::write_attribute(session, session.file(), "payload_sha256", digest.finish_hex());
  session.commit(true);
}

NamedData read_failure_bundle(const std::filesystem::path& path) {
  const hdf5::Session session = hdf5::Session::read(path);
  if (hdf5::read_text_attribute(session, session.file(), "format") != format_name)
    throw Error(ExitCode::file, fmt::format("{}: not a failure bundle.", path.string()));
  PayloadDigest digest;
  NamedData data = read_named_data(session, digest);
  if (hdf5::read_text_attribute(session, session.file(), "payload_sha256") != digest.finish_hex())
    throw Error(ExitCode::file, fmt::format("{}: the failure bundle is damaged.", path.string()));
  return data;
}

}  // namespace pileus::output

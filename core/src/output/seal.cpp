#include "output/seal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "base/sha256.hpp"

namespace pileus::output {

namespace {

struct Seal {
  char magic[8] = {'P', 'I', 'L', 'E', 'U', 'S', 'S', '1'};
  std::uint64_t content_bytes = 0;
  Sha256::Digest digest{};
};

Sha256::Digest digest_of(const StagedFile& file, std::uint64_t bytes) {
  Sha256 hash;
  std::vector<std::byte> block(std::size_t{1} << 20);
  for (std::uint64_t at = 0; at < bytes; at += block.size()) {
    const std::size_t count = std::min<std::uint64_t>(block.size(), bytes - at);
    if (!file.read(at, count, block.data())) throw file_error(file.path(), "read", errno);
    hash.update(block.data(), count);
  }
  return hash.finish();
}

}  // namespace

void add_seal(StagedFile& file) {
  Seal seal;
  seal.content_bytes = file.size();
  seal.digest = digest_of(file, seal.content_bytes);
  file.write(seal.content_bytes, sizeof seal, &seal);
}

void require_seal(const std::filesystem::path& path) {
  const StagedFile file(path, StagedFile::Mode::read);
  Seal found;
  const Seal expected;
  const std::uint64_t content = file.size() - std::min<std::uint64_t>(file.size(), sizeof found);
  if (!file.read(content, sizeof found, &found)) throw file_error(path, "read", errno);
  if (std::memcmp(found.magic, expected.magic, sizeof found.magic) != 0 ||
      found.content_bytes != content)
    throw Error(ExitCode::file,
                fmt::format("{}: the file is truncated or was not written by Pileus: it does not "
                            "end with the checksum of its content.",
                            path.string()));
  if (found.digest != digest_of(file, content))
    throw Error(ExitCode::file,
                fmt::format("{}: the file is damaged: its content does not have the checksum it "
                            "was written with.",
                            path.string()));
}

}  // namespace pileus::output

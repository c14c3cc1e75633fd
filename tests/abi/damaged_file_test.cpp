// Library files cut anywhere or with flipped bits are judged without a crash.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <random>
#include <vector>

#include "host/elf.hpp"
#include "hostile_library.hpp"

namespace pileus::test {
namespace {

std::vector<std::byte> read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> chars((std::istreambuf_iterator<char>(file)), {});
  std::vector<std::byte> bytes(chars.size());
  std::memcpy(bytes.data(), chars.data(), chars.size());
  return bytes;
}

/// Parses a copy of exactly that many bytes on the heap, so that AddressSanitizer sees any access
/// beyond them. True if the bytes were accepted.
bool accepted(const std::vector<std::byte>& bytes, std::size_t length) {
  const std::vector<std::byte> copy(bytes.begin(), bytes.begin() + static_cast<long>(length));
  try {
    const host::ElfFacts facts = host::parse_elf(copy);
    return facts.has_note;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

TEST(DamagedFile, cut_anywhere_is_refused) {
  const std::vector<std::byte> whole = read_file(hostile_path("nothing"));
  ASSERT_TRUE(accepted(whole, whole.size()));
  // The section table is the last part of the file, so no proper prefix holds all of it.
  for (std::size_t length = 0; length < whole.size(); length += length < 4096 ? 1 : 37) {
    EXPECT_FALSE(accepted(whole, length)) << "length " << length;
  }
}

TEST(DamagedFile, with_random_bytes_never_crashes) {
  const std::vector<std::byte> whole = read_file(hostile_path("nothing"));
  std::mt19937_64 random(20240611);
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<std::byte> damaged = whole;
    // Header and section table decide everything: damage is concentrated there.
    const std::size_t table = whole.size() - 64 * 40;
    for (int k = 0; k < 4; ++k) {
      const std::size_t at = random() % 2 == 0 ? random() % 64 : table + random() % (64 * 40);
      damaged[at] = static_cast<std::byte>(random());
    }
    accepted(damaged, damaged.size());
  }
}

TEST(DamagedFile, is_refused_by_the_loader_with_a_sentence) {
  const std::vector<std::byte> whole = read_file(hostile_path("nothing"));
  const auto path = std::filesystem::path(testing::TempDir()) / "libcut.so";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(whole.data()), static_cast<long>(whole.size() / 2));
  EXPECT_NE(refusal_of(path).find("is cut short or damaged"), std::string::npos)
      << refusal_of(path);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace pileus::test

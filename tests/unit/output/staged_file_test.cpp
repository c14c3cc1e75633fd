#include "output/staged_file.hpp"

#include <gtest/gtest.h>

#include <random>

#include "base/error.hpp"
#include "support.hpp"

namespace pileus::output {
namespace {

using Mode = StagedFile::Mode;

void put(StagedFile& file, std::uint64_t at, const std::string& text) {
  file.write(at, text.size(), text.data());
}

std::string get(const StagedFile& file, std::uint64_t at, std::size_t bytes) {
  std::string text(bytes, '?');
  EXPECT_TRUE(file.read(at, bytes, text.data()));
  return text;
}

TEST(StagedFile, new_file_appears_at_the_commit) {
  const ScratchFolder folder;
  {
    StagedFile file(folder / "f", Mode::create);
    put(file, 0, "hello");
    EXPECT_FALSE(std::filesystem::exists(folder / "f"));
    EXPECT_EQ(get(file, 1, 6), std::string("ello\0\0", 6)) << "beyond the end reads as zero";
    file.commit(true);
    EXPECT_EQ(bytes_of(folder / "f"), "hello");
  }
  { StagedFile dropped(folder / "g", Mode::create); }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(StagedFile, nothing_changes_before_the_commit) {
  const ScratchFolder folder;
  const std::string before(10000, 'a');
  std::ofstream(folder / "f") << before;
  {
    StagedFile file(folder / "f", Mode::update);
    put(file, 4000, std::string(200, 'b'));
    put(file, 9990, std::string(100, 'c'));
    EXPECT_EQ(bytes_of(folder / "f").substr(0, 10000), before);
    EXPECT_EQ(get(file, 3999, 202), "a" + std::string(200, 'b') + "a");
    EXPECT_EQ(get(file, 9989, 101), "a" + std::string(100, 'c'));
    EXPECT_EQ(file.size(), 10090u);
  }
  EXPECT_EQ(bytes_of(folder / "f"), before) << "a dropped update leaves no trace";
}

TEST(StagedFile, random_writes_and_cuts_equal_those_on_memory) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const ScratchFolder folder;
    std::string expected(random() % 20000, 'x');
    std::ofstream(folder / "f") << expected;
    for (int commit = 0; commit < 3; ++commit) {
      StagedFile file(folder / "f", Mode::update);
      for (int n = 0; n < 8; ++n) {
        const std::size_t at = random() % 20000;
        const std::string text(1 + random() % 6000, static_cast<char>('a' + random() % 26));
        if (expected.size() < at + text.size()) expected.resize(at + text.size(), '\0');
        expected.replace(at, text.size(), text);
        put(file, at, text);
      }
      ASSERT_EQ(get(file, 0, expected.size()), expected);
      if (random() % 3 == 0) {
        expected.resize(random() % expected.size());
        file.truncate(expected.size());
      }
      file.commit(false);
      ASSERT_EQ(bytes_of(folder / "f"), expected);
    }
    ASSERT_FALSE(std::filesystem::exists(folder / "f.journal"));
  }
}

TEST(StagedFile, writing_to_a_reader_fails_at_the_commit) {
  const ScratchFolder folder;
  std::ofstream(folder / "f") << "text";
  StagedFile file(folder / "f", Mode::read);
  put(file, 0, "x");
  EXPECT_NE(file.failure(), 0);
  EXPECT_THROW(file.commit(false), Error);
  EXPECT_EQ(bytes_of(folder / "f"), "text");
}

TEST(StagedFile, damaged_or_foreign_journals_are_ignored) {
  const ScratchFolder folder;
  std::ofstream(folder / "f") << "text";
  for (const std::string& journal :
       {std::string(), std::string("PILEUSJ1"), std::string(500, 'z')}) {
    std::ofstream(folder / "f.journal", std::ios::binary) << journal;
    { StagedFile file(folder / "f", Mode::update); }
    EXPECT_EQ(bytes_of(folder / "f"), "text");
    EXPECT_FALSE(std::filesystem::exists(folder / "f.journal"));
  }
}

}  // namespace
}  // namespace pileus::output

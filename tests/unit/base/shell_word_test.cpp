#include "base/shell_word.hpp"

#include <gtest/gtest.h>

namespace pileus {
namespace {

TEST(ShellWord, quotes_what_a_shell_would_take_apart) {
  EXPECT_EQ(shell_word("results/a_1.yaml"), "results/a_1.yaml");
  EXPECT_EQ(shell_word("sp ace"), "'sp ace'");
  EXPECT_EQ(shell_word("$(x)"), "'$(x)'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace pileus

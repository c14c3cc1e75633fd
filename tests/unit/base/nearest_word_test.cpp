// The word that was meant, judged by hand-counted edit distances.
#include "base/nearest_word.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace pileus {
namespace {

const std::vector<std::string> words = {"extent", "cells", "lower", "courant", "end"};

TEST(NearestWord, CountsInsertionsDeletionsSubstitutionsAndSwaps) {
  EXPECT_EQ(nearest_word("extnt", words), "extent");    // one letter missing
  EXPECT_EQ(nearest_word("exttent", words), "extent");  // one too many
  EXPECT_EQ(nearest_word("celss", words), "cells");     // a swap is one edit
  EXPECT_EQ(nearest_word("louer", words), "lower");     // one wrong
}

TEST(NearestWord, ToleratesAThirdOfTheLetters) {
  EXPECT_EQ(nearest_word("corunt", words), "courant");  // two edits in six letters
  EXPECT_EQ(nearest_word("cxxxxnt", words), "");        // four in seven
  EXPECT_EQ(nearest_word("ed", words), "end");          // one edit is always tolerated
  EXPECT_EQ(nearest_word("ab", words), "");
}

TEST(NearestWord, PrefersTheFirstOfEquals) {
  const std::vector<std::string> twins = {"bat", "cat"};
  EXPECT_EQ(nearest_word("rat", twins), "bat");
  EXPECT_EQ(nearest_word("cat", twins), "cat");
  EXPECT_EQ(nearest_word("cat", std::vector<std::string>{}), "");
}

}  // namespace
}  // namespace pileus

// Reading rules: the built-in ones are whole, mistakes are named with their place.
#include "planner/rules.hpp"

#include <gtest/gtest.h>

#include <set>

#include "base/error.hpp"

namespace pileus::planner {
namespace {

TEST(Rules, built_in_ones_refer_to_effects_that_come_before) {
  std::set<std::string> before;
  for (const Rule& rule : built_in_rules().list) {
    EXPECT_FALSE(rule.loss.empty()) << rule.effect;
    for (const std::string& need : rule.needs) EXPECT_EQ(before.count(need), 1u) << rule.effect;
    for (const std::string& feeder : rule.fed_by) EXPECT_EQ(before.count(feeder), 1u) << feeder;
    before.insert(rule.effect);
  }
  EXPECT_EQ(before.count("condensation"), 1u);
}

std::string complaint(const char* text) {
  try {
    read_rules("rules.yaml", text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
    return error.what();
  }
  return {};
}

TEST(Rules, name_the_place_and_the_nearest_key) {
  const std::string text = complaint("rain:\n  title: rain\n  caes: []\n");
  EXPECT_NE(text.find("rules.yaml:3:3"), std::string::npos) << text;
  EXPECT_NE(text.find("did you mean 'cases'"), std::string::npos) << text;
}

TEST(Rules, a_case_decides_by_a_verdict_or_a_number_with_a_threshold) {
  EXPECT_NE(complaint("rain:\n  title: rain\n  cases:\n    - {evidence: bound, says: no}\n")
                .find("decides by"),
            std::string::npos);
  EXPECT_NE(complaint("rain:\n  title: rain\n  cases:\n"
                      "    - {evidence: bound, says: no, number: 1}\n")
                .find("threshold"),
            std::string::npos);
}

}  // namespace
}  // namespace pileus::planner

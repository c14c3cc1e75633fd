// Formulas: the vocabulary a scene may use, and where a mistake is.
#include "scene/formula.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace pileus::scene {
namespace {

const std::map<std::string, double> constants = {{"H", 1000.0}, {"N", 0.01}};

double at(const std::string& text, double x, double z) {
  Formula formula(text, {"x", "z"}, constants);
  const std::array<double, 2> values = {x, z};
  return formula(values.data());
}

TEST(Formula, KnowsTheFunctionsOfTheField) {
  EXPECT_EQ(at("exp(-z/H)", 0, 500), std::exp(-0.5));
  EXPECT_EQ(at("x > 1 ? 2 : 3", 2, 0), 2);
  EXPECT_EQ(at("if(x > 1, 2, 3)", 0, 0), 3);
  EXPECT_EQ(at("max(0, min(z, 5))", 0, 7), 5);
  EXPECT_EQ(at("tanh(x) + sqrt(z)", 0.5, 4), std::tanh(0.5) + 2);
  EXPECT_EQ(at("clip(x, -1, 1)", -3, 0), -1);
  EXPECT_EQ(at("step(x)", 0, 0), 1);
  EXPECT_EQ(at("mod(x, 3)", -1, 0), 2);
  EXPECT_EQ(at("floor(x) + ceil(x)", 1.5, 0), 3);
  EXPECT_EQ(at("pi", 0, 0), 3.14159265358979323846);
  EXPECT_EQ(at("2^3^2", 0, 0), 512);  // right-associative
  EXPECT_EQ(at("-x^2", 3, 0), -9);
  EXPECT_EQ(at("x <= 1 && z != 2 || 0", 1, 3), 1);
}

TEST(Formula, NestedConditionsChooseOneBranch) {
  const std::string ramp = "x <= 0 ? 1 : (x < 1 ? 1 - x : 0)";
  EXPECT_EQ(at(ramp, -1, 0), 1);
  EXPECT_EQ(at(ramp, 0.25, 0), 0.75);
  EXPECT_EQ(at(ramp, 2, 0), 0);
}

TEST(Formula, KnowsWhatItUses) {
  const Formula formula("N^2*z", {"x", "z"}, constants);
  EXPECT_FALSE(formula.uses(0));
  EXPECT_TRUE(formula.uses(1));
}

TEST(Formula, CopiesAreIndependent) {
  Formula first("x + z", {"x", "z"}, constants);
  Formula second = first;
  const std::array<double, 2> a = {1, 2}, b = {10, 20};
  EXPECT_EQ(first(a.data()), 3);
  EXPECT_EQ(second(b.data()), 30);
  EXPECT_EQ(first(a.data()), 3);
}

TEST(Formula, SaysWhereItIsWrong) {
  const auto unknown = check_formula("1 + hieght", {"height"}, {});
  ASSERT_TRUE(unknown);
  EXPECT_EQ(unknown->position, 4u);
  EXPECT_EQ(unknown->text, "unknown name 'hieght' in the formula; did you mean 'height'?");
  const auto open = check_formula("sin(x", {"x"}, {});
  ASSERT_TRUE(open);
  EXPECT_EQ(open->position, 5u);
  EXPECT_TRUE(check_formula("", {}, {}));
  EXPECT_TRUE(check_formula("x = 3", {"x"}, {}));
  EXPECT_TRUE(check_formula("1, 2", {}, {}));
  EXPECT_FALSE(check_formula("x == 3", {"x"}, {}));
}

TEST(Formula, DomainErrorsAreNotExceptions) {
  EXPECT_TRUE(std::isnan(at("sqrt(x)", -1, 0)));
  EXPECT_TRUE(std::isinf(at("1/x", 0, 0)));
}

TEST(FreeName, LeavesTheVocabularyAlone) {
  EXPECT_TRUE(is_free_name("q_0"));
  for (const char* taken : {"x", "y", "z", "pi", "sin", "if", "clip", "", "2a", "a-b", "a b"})
    EXPECT_FALSE(is_free_name(taken)) << taken;
}

}  // namespace
}  // namespace pileus::scene

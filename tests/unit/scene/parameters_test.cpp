// Parameters of operators against their declarations.
#include "scene/parameters.hpp"

#include <gtest/gtest.h>

#include "scene_text.hpp"

namespace pileus::scene {
namespace {

std::vector<ParameterDeclaration> declarations() {
  return {
      {.name = "thermodynamics", .type = ParameterType::choice, .choices = {"ideal", "real"}},
      {.name = "time_scale", .units = "s", .fallback = 3600, .low = 1, .high = 1e6},
      {.name = "iterations", .type = ParameterType::integer, .fallback = 6, .low = 1, .high = 50},
      {.name = "ice", .type = ParameterType::toggle},
      {.name = "table", .type = ParameterType::text, .text_fallback = "standard"},
      {.name = "heights",
       .type = ParameterType::numbers,
       .units = "m",
       .when = "thermodynamics == real"},
      {.name = "descent", .type = ParameterType::profile, .units = "m s-1", .low = -1, .high = 1},
      {.name = "warming", .type = ParameterType::series, .units = "K s-1", .fallback = 2},
  };
}

struct Checked {
  ParameterValues values;
  std::string problems;
};

Checked check(const std::string& parameters) {
  const Scene scene = scene_of("constants: {tau: 2 h}\n" + cube +
                               "operators:\n  - {use: org.a.relax" + parameters + "}\n");
  Problems problems;
  Checked result;
  result.values =
      validate_parameters(scene.operators[0], declarations(), scene.constants, problems);
  result.problems = problems.render();
  return result;
}

/// Plugins get integers as doubles, which hold every whole number up to 2^53 and no further.
TEST(Parameters, AreIntegersThatADoubleHolds) {
  const auto problems_of = [](const char* number) {
    const Scene scene = scene_of(cube + "operators:\n  - {use: org.a.count, n: " + number + "}\n");
    Problems problems;
    const std::vector<ParameterDeclaration> declared = {
        {.name = "n", .type = ParameterType::integer}};
    const auto read = validate_parameters(scene.operators[0], declared, {}, problems);
    if (problems.empty()) {
      EXPECT_EQ(std::to_string(static_cast<std::int64_t>(read.number[0])), number);
    }
    return problems.render();
  };
  EXPECT_EQ(problems_of("9007199254740992"), "");
  EXPECT_EQ(problems_of("-9007199254740992"), "");
  for (const char* number : {"9007199254740993", "-9007199254740993", "9223372036854775807"})
    EXPECT_NE(problems_of(number).find("at most 2^53"), std::string::npos) << number;
}

TEST(Parameters, TakeDefaultsUnitsAndConstants) {
  const Checked plain = check("");
  EXPECT_EQ(plain.problems, "");
  EXPECT_EQ(plain.values.number, (std::vector<double>{0, 3600, 6, 0, 0, 0, 0, 2}));
  EXPECT_EQ(plain.values.text[0], "ideal");
  EXPECT_EQ(plain.values.text[4], "standard");
  EXPECT_EQ(plain.values.list[5], std::vector<double>{0});

  const Checked given = check(
      ", thermodynamics: real, time_scale: tau/2, iterations: 9, ice: on, table: mine, heights: [0 "
      "m, 1 km]");
  EXPECT_EQ(given.problems, "");
  EXPECT_EQ(given.values.number[0], 1);
  EXPECT_EQ(given.values.number[1], 3600);
  EXPECT_EQ(given.values.number[2], 9);
  EXPECT_EQ(given.values.number[3], 1);
  EXPECT_EQ(given.values.text[4], "mine");
  EXPECT_EQ(given.values.list[5], (std::vector<double>{0, 1000}));
  EXPECT_TRUE(given.values.given[5]);
  EXPECT_FALSE(plain.values.given[5]);
}

TEST(Parameters, RefusalsNameThePlaceAndWhatIsAllowed) {
  EXPECT_EQ(check(", time_scal: 3").problems,
            "scene.yaml:5:24: error: operator 'relax' has no parameter 'time_scal'; did you mean "
            "'time_scale'?");
  EXPECT_EQ(
      check(", time_scale: 3 kg").problems,
      "scene.yaml:5:36: error: parameter 'time_scale' of operator 'relax': in '3 kg' 'kg' does "
      "not measure a time; expected a value such as '10 min'");
  EXPECT_EQ(check(", time_scale: 0").problems,
            "scene.yaml:5:36: error: parameter 'time_scale' of operator 'relax': 0 s must be "
            "between 1 and 1e+06 s");
  EXPECT_EQ(
      check(", thermodynamics: reel").problems,
      "scene.yaml:5:40: error: parameter 'thermodynamics' of operator 'relax': expected 'ideal' "
      "or 'real', found 'reel'; did you mean 'real'?");
  EXPECT_NE(check(", iterations: 2.5").problems.find("expected a whole number"), std::string::npos);
  EXPECT_NE(check(", iterations: 60").problems.find("between 1 and 50"), std::string::npos);
  EXPECT_NE(check(", ice: maybe").problems.find("'true' or 'false'"), std::string::npos);
  EXPECT_NE(check(", time_scale: [1, 2]").problems.find("found a list of 2"), std::string::npos);
}

TEST(Parameters, OnesWithoutAMeaningAreRefused) {
  EXPECT_EQ(check(", heights: [0, 1]").problems,
            "scene.yaml:5:24: error: parameter 'heights' of operator 'relax' means something only "
            "when thermodynamics == real");
}

TEST(Conditions, JoinComparisons) {
  const auto declared = declarations();
  const ParameterValues values = check(", thermodynamics: real, ice: true, iterations: 7").values;
  EXPECT_TRUE(condition_holds("", declared, values));
  EXPECT_TRUE(condition_holds("ice == true and thermodynamics == real", declared, values));
  EXPECT_FALSE(condition_holds("ice == true and thermodynamics != real", declared, values));
  EXPECT_FALSE(condition_holds("ice != true", declared, values));
  EXPECT_TRUE(condition_holds("iterations == 7", declared, values));
}

TEST(Parameters, AreFunctionsOfHeightOrTime) {
  using List = std::vector<double>;
  const Checked all = check(
      ", descent: {height: [0 m, 1.5 km], value: [0 cm/s, -25 cm/s]}, warming: {time: [0 h, 1 "
      "h], "
      "value: [1, 0]}");
  EXPECT_EQ(all.problems, "");
  EXPECT_EQ(all.values.list[6], (List{0, 0, 1500, -0.25}));
  EXPECT_EQ(all.values.list[7], (List{0, 1, 3600, 0}));
  const Checked constant = check(", descent: -0.5");
  EXPECT_EQ(constant.values.list[6], (List{0, -0.5}));
  EXPECT_EQ(constant.values.list[7], (List{0, 2}));
}

TEST(Parameters, OfHeightOrTimeNameTheirMistakes) {
  const auto expect_problem = [](const std::string& text, const std::string& phrase) {
    const std::string problems = check(", " + text).problems;
    EXPECT_NE(problems.find(phrase), std::string::npos) << problems;
  };
  expect_problem("descent: [0, 1]", "expected a value or the lists 'height' and 'value'");
  expect_problem("descent: {time: [0 s], value: [0]}",
                 "expected the lists 'height' and 'value', found 'time'");
  expect_problem("descent: {height: [0 m, 1 m], value: [0]}", "they have 2 and 1 entries");
  expect_problem("descent: {height: [1 m, 1 m], value: [0, 0]}", "its heights must ascend");
  expect_problem("descent: {height: [0 m], value: [2]}", "must be between -1 and 1 m s-1");
  expect_problem("descent: {height: [0 s], value: [0]}", "descent");
  expect_problem("warming: {time: [0 s, -1 s], value: [0, 1]}", "its times must ascend");
  expect_problem("time_scale: {height: [0 m], value: [0]}", "expected a value, found a mapping");
}

}  // namespace
}  // namespace pileus::scene

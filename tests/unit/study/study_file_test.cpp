// Reading studies: what they may say, and what is said about mistakes.
#include "study/study_file.hpp"

#include <cstdlib>

#include "scene/tree.hpp"
#include "study_text.hpp"

namespace pileus::study {
namespace {

using StudyFile = StudyTest;

const std::string head = R"(scene: cube.yaml
errors:
  - {name: energy, diagnostic: total_energy, statistic: relative_change}
)";

TEST_F(StudyFile, TakesKnobsOfOneAndOfSeveralKeys) {
  scene::Problems problems;
  const Study study = read_study(write("study.yaml", head + R"(
knobs:
  - {key: time.step.alpha, values: [0.4, 0.2]}
  - name: scheme
    keys: [time.scheme, domain.cells]
    values: [[rk3, [4, 4, 4]], [rk4, [8, 8, 8]]]
    numbers: [3, 4]
    labels: [third, fourth]
)"),
                                 problems);
  EXPECT_EQ(problems.render(), "");
  ASSERT_EQ(study.knobs.size(), 2U);
  EXPECT_EQ(study.knobs[0].name, "alpha");
  EXPECT_EQ(study.knobs[0].ladder[1].number, 0.2);
  EXPECT_EQ(study.knobs[0].ladder[1].label, "0.2");
  const Rung& rung = study.knobs[1].ladder[1];
  EXPECT_EQ(rung.label, "fourth");
  EXPECT_EQ(rung.number, 4);
  ASSERT_EQ(rung.settings.size(), 2U);
  EXPECT_EQ(rung.settings[1].key + "=" + scene::flow_text(rung.settings[1].value),
            "domain.cells=[8, 8, 8]");
}

TEST_F(StudyFile, NumbersOfValuesAreInSi) {
  scene::Problems problems;
  const Study study = read_study(
      write("study.yaml", head + "knobs: [{key: time.step.largest, values: [2 min, 500 ms]}]\n"),
      problems);
  EXPECT_EQ(study.knobs[0].ladder[0].number, 120);
  EXPECT_EQ(study.knobs[0].ladder[1].number, 0.5);
}

TEST_F(StudyFile, NamesTheNearestKey) {
  EXPECT_EQ(problems_of(head + "knobs: [{key: time.step.alpha, valuse: [0.4, 0.2]}]\n"),
            "study.yaml:4:32: error: unknown key 'valuse' in 'knobs'; did you mean 'values'?\n"
            "  4 | knobs: [{key: time.step.alpha, valuse: [0.4, 0.2]}]\n"
            "    |                                ^~~~~~");
}

TEST_F(StudyFile, BlamesASettingTheSceneRefusesOnItsPlaceInTheStudy) {
  EXPECT_EQ(problems_of(head + "knobs: [{key: time.step.alpha, values: [0.4, -0.2]}]\n"),
            "study.yaml:4:46: error: 'alpha' = -0.2 must be greater than 0 and at most 10\n"
            "  4 | knobs: [{key: time.step.alpha, values: [0.4, -0.2]}]\n"
            "    |                                              ^~~~");
}

TEST_F(StudyFile, BlamesAnUnknownKeyOfTheSceneOnTheKnob) {
  const std::string words =
      problems_of(head + "knobs:\n  - {key: time.stp.alpha, values: [0.4]}\n");
  EXPECT_EQ(words.substr(0, words.find('\n')),
            "study.yaml:5:5: error: unknown key 'stp' in 'time'; did you mean 'step'?");
}

TEST_F(StudyFile, AsksForALadderThatNoOperatorDeclares) {
  const std::string words = problems_of(head + "knobs:\n  - {key: time.step.alpha}\n");
  EXPECT_EQ(words.substr(0, words.find('\n')),
            "study.yaml:5:5: error: the knob 'alpha' has no 'values', and no operator of the scene "
            "declares a ladder for 'time.step.alpha'");
}

TEST_F(StudyFile, KnowsItsOwnNames) {
  const std::string words = problems_of(head + R"(
knobs: [{key: time.step.alpha, values: [0.4, 0.2]}]
published: [{label: A, errors: {enrgy: 1}, source: somewhere}]
expect: [{error: energy, points: {alpha: 0.3}, at_most: 1, source: x}]
)");
  EXPECT_NE(words.find("no error of this study is called 'enrgy'; did you mean 'energy'?"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("no value of the knob 'alpha' of this study is called '0.3'"),
            std::string::npos)
      << words;
}

TEST_F(StudyFile, RefusesAnEmptyStudyAndAMissingOne) {
  EXPECT_EQ(problems_of("").substr(0, 80),
            "study.yaml:1:1: error: the file is empty; a study needs at least 'knobs' and 'er");
  scene::Problems problems;
  EXPECT_THROW(read_study((folder_ / "none.yaml").string(), problems), std::runtime_error);
}

TEST_F(StudyFile, LaysOutProductsAndStars) {
  const std::string knobs = R"(
knobs:
  - {key: time.step.alpha, values: [0.4, 0.2, 0.1]}
  - {key: time.scheme, values: [rk3, rk4]}
)";
  scene::Problems problems;
  const Layout product = lay_out(read_study(write("a.yaml", head + knobs), problems), problems);
  EXPECT_EQ(problems.render(), "");
  EXPECT_EQ(product.points.size(), 6U);
  ASSERT_EQ(product.curves.size(), 5U);  // two along alpha, three along the scheme
  EXPECT_EQ(product.curves[0].label, "rk3");
  EXPECT_EQ(product.points[product.curves[0].points[2]].label, "alpha 0.1, rk3");
  EXPECT_FALSE(product.finest);

  const Layout star = lay_out(
      read_study(write("b.yaml", head + knobs + "combine: one_at_a_time\n"), problems), problems);
  EXPECT_EQ(star.points.size(), 5U);
  EXPECT_EQ(star.curves.size(), 2U);
  EXPECT_EQ(star.points[0].rungs, (std::vector<int>{0, -1}));
}

TEST_F(StudyFile, TheSameSceneHasTheSameKeyHoweverItIsWritten) {
  scene::Problems problems;
  const Layout layout = lay_out(
      read_study(write("a.yaml", head + "knobs: [{key: time.step.alpha, values: [0.4, 4/10], "
                                        "labels: [a, b], numbers: [1, 2]}]\n"),
                 problems),
      problems);
  EXPECT_EQ(problems.render(), "");
  EXPECT_EQ(layout.points[0].runs[0].key, layout.points[1].runs[0].key);
}

TEST_F(StudyFile, TheFinestRunIsOneOfThePointsOrOneMore) {
  const std::string norm = R"(scene: cube.yaml
errors: [{name: w, field: z_velocity}]
knobs: [{key: time.step.alpha, values: [0.4, 0.2]}]
)";
  scene::Problems problems;
  const Layout among = lay_out(read_study(write("a.yaml", norm), problems), problems);
  EXPECT_EQ(among.finest, 1U);
  EXPECT_EQ(among.points.size(), 2U);
  const Layout extra = lay_out(
      read_study(write("b.yaml", norm + "finest: {time.step.alpha: 0.05}\n"), problems), problems);
  EXPECT_EQ(extra.finest, 2U);
  EXPECT_TRUE(extra.points[2].only_reference);
  EXPECT_EQ(problems.render(), "");
}

TEST_F(StudyFile, SeedsGoWhereTheStudySaysAndGiveARunEach) {
  scene::Problems problems;
  const Layout layout = lay_out(read_study(write("a.yaml", head + R"(
knobs: [{key: parcels.per_cell, values: [1, 8]}]
seeds: [5, 7]
seed_keys: [parcels.seed]
)"),
                                           problems),
                                problems);
  EXPECT_EQ(problems.render(), "");
  ASSERT_EQ(layout.points[0].runs.size(), 2U);
  EXPECT_NE(layout.points[0].runs[0].key, layout.points[0].runs[1].key);
  EXPECT_NE(layout.points[0].runs[1].resolved.find("seed: 7"), std::string::npos);
}

}  // namespace
}  // namespace pileus::study

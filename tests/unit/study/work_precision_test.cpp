// Orders, spreads, the Pareto front and verdicts on made-up findings.
#include "study/work_precision.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "study/duration_model.hpp"
#include "study/study_table.hpp"
#include "study/work_precision_picture.hpp"

namespace pileus::study {
namespace {

/// One knob with the given numbers, a point at each with this error and cost.
Findings findings_of(const std::vector<double>& numbers, const std::vector<double>& errors,
                     const std::vector<double>& costs) {
  Findings findings;
  ErrorNorm norm;
  norm.name = "error";
  findings.study.errors = {norm};
  Knob knob;
  knob.name = "knob";
  KnobCurve curve{"", 0, {}};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    knob.ladder.push_back({std::to_string(i), numbers[i], {}});
    curve.points.push_back(i);
    PointResult point;
    point.label = std::to_string(i);
    point.rungs = {static_cast<int>(i)};
    point.cost = {costs[i], costs[i], costs[i]};
    point.errors = {{errors[i], errors[i], errors[i]}};
    findings.points.push_back(point);
  }
  findings.layout.knobs = {knob};
  findings.layout.curves = {curve};
  return findings;
}

TEST(WorkPrecision, OrdersAreExactForPowersWhicheverWayTheLadderRuns) {
  const auto cubes = [](double n) { return 7 * std::pow(n, -3); };
  const Findings cells = findings_of({8, 16, 64}, {cubes(8), cubes(16), cubes(64)}, {1, 2, 3});
  const Orders falling = cells.orders(0, 0);
  EXPECT_TRUE(std::isnan(falling.local[0]));
  EXPECT_NEAR(falling.local[1], 3, 1e-12);
  EXPECT_NEAR(falling.local[2], 3, 1e-12);
  EXPECT_NEAR(falling.overall, 3, 1e-12);

  const Findings steps = findings_of({0.4, 0.2, 0.1}, {16e-4, 1e-4, 1e-4 / 16}, {1, 2, 4});
  EXPECT_NEAR(steps.orders(0, 0).local[2], 4, 1e-12);
  EXPECT_NEAR(steps.orders(0, 0).overall, 4, 1e-12);
}

TEST(WorkPrecision, AKnobThatBeginsAtZeroHasItsPanelOfTheOtherValues) {
  const Findings betas = findings_of({0, 0.3, 3}, {0.4, 0.2, 0.3}, {1, 1, 1});
  const Findings words = findings_of({not_a_number, not_a_number}, {0.4, 0.2}, {1, 1});
  EXPECT_EQ(work_precision_size(betas).width, 2 * work_precision_size(words).width);
  EXPECT_NE(work_precision_script(betas, 0).find("set xtics (0.3, 3)"), std::string::npos)
      << work_precision_script(betas, 0);
}

TEST(WorkPrecision, AFailedPointLeavesAGapInTheOrders) {
  Findings findings = findings_of({0.4, 0.2, 0.1}, {16e-4, 1e-4, 1e-4 / 16}, {1, 2, 4});
  findings.points[1].errors[0] = {};
  const Orders orders = findings.orders(0, 0);
  EXPECT_TRUE(std::isnan(orders.local[1]));
  EXPECT_TRUE(std::isnan(orders.local[2]));
  EXPECT_NEAR(orders.overall, 4, 1e-12);
}

TEST(WorkPrecision, TheFrontHoldsWhatNothingBeats) {
  // 1 is beaten by 0 (as accurate, cheaper), 3 by 2 (as cheap, more accurate).
  const Findings findings =
      findings_of({1, 2, 3, 4, 5}, {0.5, 0.5, 0.1, 0.2, 0.01}, {1, 2, 3, 3, 9});
  EXPECT_EQ(findings.front(0), (std::vector<std::size_t>{0, 2, 4}));
}

TEST(WorkPrecision, TheFrontLeavesOutWhatHasNoErrorOrIsOnlyAReference) {
  Findings findings = findings_of({1, 2, 3}, {0.5, 0.1, 0.01}, {1, 2, 3});
  findings.points[1].errors[0] = {};
  findings.points[2].only_reference = true;
  EXPECT_EQ(findings.front(0), (std::vector<std::size_t>{0}));
}

TEST(WorkPrecision, SpreadsLeaveOutWhatIsMissing) {
  const double nan = std::nan("");
  const Spread mean = mean_of({3, nan, 1});
  EXPECT_EQ(mean.value, 2);
  EXPECT_EQ(mean.low, 1);
  EXPECT_EQ(mean.high, 3);
  EXPECT_EQ(median_of({9, 1, 2}).value, 2);
  EXPECT_EQ(median_of({9, 1}).value, 5);
  EXPECT_FALSE(mean_of({nan}).known());
}

TEST(WorkPrecision, AChangeSmallerThanTheSpreadIsNotResolved) {
  Findings findings = findings_of({1, 2}, {1.0, 0.9}, {1, 2});
  EXPECT_TRUE(findings.is_resolved(0, 1, 0));
  findings.points[0].errors[0] = {1.0, 0.9, 1.1};
  findings.points[1].errors[0] = {0.9, 0.8, 1.05};
  EXPECT_FALSE(findings.is_resolved(0, 1, 0));
}

TEST(WorkPrecision, BoundsHoldForEverySeedAndMustSpeakOfSomething) {
  Findings findings = findings_of({1, 2}, {0.5, 0.1}, {1, 2});
  findings.points[1].errors[0].high = 0.3;
  StudyExpectation bound;
  bound.norm = "error";
  bound.along = "knob";
  bound.high = 0.2;
  bound.points = {{"knob", "1"}};
  StudyExpectation order = bound;
  order.of = StudyExpectation::Of::order;
  order.points = {};
  order.high = {};
  order.low = 2;
  StudyExpectation nothing = bound;
  nothing.points = {{"knob", "no such label"}};
  findings.study.expect = {bound, order, nothing};
  const std::vector<Verdict> verdicts = judge(findings);
  ASSERT_EQ(verdicts.size(), 3U);
  EXPECT_FALSE(verdicts[0].passed);  // 0.3 for one seed
  EXPECT_EQ(verdicts[0].value, 0.3);
  EXPECT_TRUE(verdicts[1].passed);  // ln 5/ln 2
  EXPECT_FALSE(verdicts[2].passed);
}

TEST(WorkPrecision, ALineSumsUpWhatKeepsABoundAndEveryMissHasItsOwn) {
  Findings findings = findings_of({1, 2, 4, 8}, {0.5, 0.4, 0.2, 0.1}, {1, 2, 3, 4});
  StudyExpectation bound;
  bound.norm = "error";
  bound.high = 0.3;
  bound.source = "made up";
  findings.study.expect = {bound};
  const std::string table = findings_table(findings, judge(findings));
  EXPECT_NE(table.find("MISS  error (0) = 0.5 <= 0.3  (made up)"), std::string::npos) << table;
  EXPECT_NE(table.find("MISS  error (1) = 0.4 <= 0.3"), std::string::npos) << table;
  EXPECT_NE(table.find("pass  error (2 points) = 0.1 to 0.2 <= 0.3"), std::string::npos) << table;
}

TEST(WorkPrecision, NothingUnmeasuredPasses) {
  Findings findings = findings_of({1}, {0.5}, {1});
  findings.points[0].errors[0] = {};
  StudyExpectation bound;
  bound.norm = "error";
  bound.high = 1;
  findings.study.expect = {bound};
  EXPECT_FALSE(judge(findings).at(0).passed);
}

TEST(DurationModel, FollowsPowersOfTheKnobs) {
  DurationModel model(2);
  EXPECT_FALSE(model.predict({0, 0}));
  const auto cost = [](double n, double alpha) { return 1e-3 * std::pow(n, 3) / alpha; };
  for (const double n : {8.0, 16.0, 32.0})
    for (const double alpha : {0.4, 0.2})
      model.learn({std::log(n), std::log(alpha)}, cost(n, alpha));
  // The ridge leaves each slope short by its share of the knob's variance, at most 3 per cent here.
  const double predicted = *model.predict({std::log(64), std::log(0.1)});
  EXPECT_NEAR(predicted / cost(64, 0.1), 1, 0.1);
}

TEST(DurationModel, OneRunIsTheExpectationOfAll) {
  DurationModel model(1);
  model.learn({0}, 12);
  EXPECT_NEAR(*model.predict({3}), 12, 1e-9);
}

/// Powers of ten alone would leave such an axis without a number.
TEST(WorkPrecision, AxesWithinADecadeHaveNumbers) {
  const std::string narrow =
      work_precision_script(findings_of({8, 4, 2}, {0.0356, 0.0383, 0.0399}, {1, 10, 100}), 0);
  EXPECT_NE(narrow.find("set ytics (0.03, 0.035, 0.04, 0.045, 0.05)"), std::string::npos) << narrow;
  EXPECT_NE(narrow.find("set xtics autofreq"), std::string::npos);
  const std::string wider =
      work_precision_script(findings_of({8, 4, 2}, {0.03, 0.1, 0.4}, {1, 10, 100}), 0);
  EXPECT_NE(wider.find("set ytics (0.05, 0.1, 0.2, 0.5)"), std::string::npos) << wider;
  const std::string decades =
      work_precision_script(findings_of({8, 4, 2}, {1e-3, 0.1, 0.4}, {1, 10, 100}), 0);
  EXPECT_NE(decades.find("set ytics autofreq"), std::string::npos);
}

}  // namespace
}  // namespace pileus::study

// Studies with runs that are made up: isolation, resumption, files, and choosing from them.
#include "study/run_study.hpp"

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/signals.hpp"
#include "output/field_file.hpp"
#include "output/read_fields.hpp"
#include "study/target_error.hpp"
#include "study_text.hpp"

namespace pileus::study {
namespace {

namespace fs = std::filesystem;

/// Stands for `pileus run`: the error is α⁴, the cost 1/α; α = 0.3 breaks down.
class MadeUpRuns {
 public:
  ProcessResult operator()(const ProcessRequest& request, const Watcher& watcher) {
    ++*count_;
    watcher(0.5);
    double alpha = 0;
    for (const std::string& setting : request.overrides)
      if (setting.starts_with("time.step.alpha=")) alpha = std::stod(setting.substr(16));
    if (alpha == 0.3) return {4, "the solution broke down\nin detail"};
    fs::create_directories(request.folder);
    nlohmann::json summary = {
        {"commit", "abc"},
        {"steps", 1 / alpha},
        {"wall_s", 2 / alpha},
        {"parcels", {{"mean", 1000}}},
        {"ns_per_parcel_step", 1e6},
        {"phases", {{"deposit", {{"seconds", 3 / alpha}}}, {"diagnostics", {{"seconds", 100}}}}}};
    std::ofstream(request.folder / "summary.json") << summary;
    fs::remove(request.folder / "series.nc");
    output::SeriesFile series(request.folder / "series.nc", {{"total_energy", "m2 s-2", "", ""}},
                              {}, output::Start::fresh());
    series.append(0, std::vector<double>{1});
    series.append(1, std::vector<double>{1 + alpha * alpha * alpha * alpha});
    return {0, ""};
  }
  int count() const { return *count_; }

 private:
  std::shared_ptr<int> count_ = std::make_shared<int>(0);
};

class RunStudy : public StudyTest {
 protected:
  void SetUp() override {
    StudyTest::SetUp();
    request_.path = write("studies/steps.yaml", R"(
scene: ../cube.yaml
knobs: [{key: time.step.alpha, values: [0.4, 0.3, 0.2, 0.1]}]
errors: [{name: energy, diagnostic: total_energy, statistic: relative_change}]
expect: [{error: energy, of: order, at_least: 3.99, at_most: 4.01, source: made up}]
)");
    request_.directory = (folder_ / "out").string();
    request_.draw = false;
  }
  void TearDown() override {
    request_stop(0);
    StudyTest::TearDown();
  }

  StudyResult run(const PointRunner& runner) {
    std::ostringstream messages;
    table_.str("");
    return run_study(request_, {.quiet = true}, messages, table_, runner);
  }

  StudyRequest request_;
  std::ostringstream table_;
};

TEST_F(RunStudy, AFailedRunIsReportedAndDoesNotEndTheStudy) {
  MadeUpRuns runs;
  const StudyResult result = run(runs);
  EXPECT_EQ(runs.count(), 4);
  EXPECT_EQ(result.code(), ExitCode::done) << table_.str();
  EXPECT_NE(table_.str().find("failed: 0.3: exit code 4: the solution broke down"),
            std::string::npos)
      << table_.str();
  // Diagnostics and output are no part of the cost.
  EXPECT_NEAR(result.findings.points[3].wall_time.value, 30, 1e-12);
  EXPECT_NEAR(result.findings.points[3].cost.value, 10, 1e-9);
  EXPECT_NEAR(result.findings.points[3].errors[0].value, 1e-4, 1e-12);
}

TEST_F(RunStudy, MakesFinishedRunsOnlyOnce) {
  MadeUpRuns runs;
  run(runs);
  run(runs);
  EXPECT_EQ(runs.count(), 4);
  // Another value is another run; those that were there stay.
  write("studies/steps.yaml", R"(
scene: ../cube.yaml
knobs: [{key: time.step.alpha, values: [0.4, 0.2, 0.05]}]
errors: [{name: energy, diagnostic: total_energy, statistic: relative_change}]
)");
  run(runs);
  EXPECT_EQ(runs.count(), 5);
  request_.force = true;
  run(runs);
  EXPECT_EQ(runs.count(), 8);
}

TEST_F(RunStudy, AStopEndsItAndTheNextCallContinues) {
  MadeUpRuns runs;
  int calls = 0;
  const StudyResult stopped = run([&](const ProcessRequest& request, const Watcher& watcher) {
    if (++calls == 3) {
      request_stop(15);
      return ProcessResult{75, ""};
    }
    return runs(request, watcher);
  });
  EXPECT_EQ(stopped.code(), ExitCode::stopped);
  EXPECT_EQ(runs.count(), 2);
  EXPECT_FALSE(fs::exists(folder_ / "out/study.json"));
  request_stop(0);
  EXPECT_EQ(run(runs).code(), ExitCode::done);
  EXPECT_EQ(runs.count(), 4);
}

TEST_F(RunStudy, ARunThatTheMachineEndedIsMadeAgain) {
  MadeUpRuns runs;
  EXPECT_THROW(run([](const ProcessRequest&, const Watcher&) {
                 return ProcessResult{5, "the disk is full"};
               }),
               Error);
  run(runs);
  EXPECT_EQ(runs.count(), 4);
}

TEST_F(RunStudy, NamesADiagnosticThatRunsDoNotHaveAfterTheFirst) {
  write("studies/steps.yaml", R"(
scene: ../cube.yaml
knobs: [{key: time.step.alpha, values: [0.4, 0.2]}]
errors: [{name: energy, diagnostic: total_enrgy}]
)");
  MadeUpRuns runs;
  try {
    run(runs);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
    EXPECT_NE(std::string(error.what()).find("did you mean 'total_energy'?"), std::string::npos);
  }
  EXPECT_EQ(runs.count(), 1);
}

TEST_F(RunStudy, WritesATableThatReadsBack) {
  run(MadeUpRuns());
  const output::ResultsFile file(folder_ / "out/study.nc");
  EXPECT_EQ(file.read("alpha"), (std::vector<double>{0.4, 0.3, 0.2, 0.1}));
  EXPECT_NEAR(file.read("error_energy").at(2), 16e-4, 1e-12);
  std::ifstream csv(folder_ / "out/study.csv");
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line.substr(0, 17), "label,alpha,cost,");
}

class TargetError : public RunStudy {
 protected:
  void SetUp() override {
    RunStudy::SetUp();
    request_.keep = true;
    run(MadeUpRuns());
    target_.scene_path = (folder_ / "cube.yaml").string();
    target_.norm = "energy";
  }

  std::string refusal(const std::string& target) {
    target_.target = target;
    try {
      choose_setting(target_);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::usage);
      return error.what();
    }
    ADD_FAILURE() << "not refused";
    return {};
  }

  TargetRequest target_;
};

TEST_F(TargetError, TakesTheCheapestThatMeetsIt) {
  target_.target = "1%";  // 0.2⁴ = 0.16 %, 0.4⁴ = 2.6 %
  const Choice choice = choose_setting(target_);
  EXPECT_EQ(choice.overrides, (std::vector<std::string>{"time.step.alpha=0.2"}));
  EXPECT_NE(choice.explanation.find("studies/results/steps.json"), std::string::npos);
  EXPECT_NE(choice.explanation.find("(commit abc)"), std::string::npos) << choice.explanation;
  // 1000 parcels for 1e6 ns each and step, in three times that
  EXPECT_NE(choice.explanation.find("took 3.0 times its processor time"), std::string::npos)
      << choice.explanation;
  target_.target = "3e-2";
  EXPECT_EQ(choose_setting(target_).overrides.at(0), "time.step.alpha=0.4");
}

TEST_F(TargetError, RefusesWhatNothingMeetsAndNamesTheBest) {
  const std::string words = refusal("1e-6");
  EXPECT_NE(words.find("no measured setting reaches '1e-6'"), std::string::npos) << words;
  EXPECT_NE(words.find("time.step.alpha=0.1"), std::string::npos) << words;
}

TEST_F(TargetError, RefusesWhatWasNotMeasured) {
  target_.norm = "enrgy";
  EXPECT_NE(refusal("1%").find("did you mean 'energy'?"), std::string::npos);
  target_.norm = "energy";
  target_.overrides = {"time.end=3"};
  EXPECT_NE(refusal("1%").find("measured without '--set time.end=3'"), std::string::npos);
  target_.overrides = {"output.fields.every=1"};
  target_.target = "1%";
  EXPECT_NO_THROW(choose_setting(target_));
  target_.scene_path = write("other.yaml", cube_scene);
  EXPECT_NE(refusal("1%").find("nothing was measured for this scene"), std::string::npos);
}

TEST_F(TargetError, RefusesASceneThatHasChanged) {
  write("cube.yaml",
        "# a comment changes nothing, nor do words and bounds\nscene: {title: Cube}\n" +
            cube_scene + "expect: [{diagnostic: volume, at_least: 0, source: made up}]\n");
  target_.target = "1%";
  EXPECT_NO_THROW(choose_setting(target_));
  write("cube.yaml",
        "domain: {extent: 1 m, cells: [4, 4, 4]}\n"
        "time: {end: 10 s, step: {alpha: 0.3}}\n");  // every point has its own alpha
  EXPECT_NO_THROW(choose_setting(target_));
  write("cube.yaml", cube_scene + "numerics: {window_compensation: 0}\n");
  EXPECT_NE(refusal("1%").find("the scene has changed since it was measured"), std::string::npos);
}

TEST_F(TargetError, RefusesTargetsThatAreNone) {
  EXPECT_NE(refusal("-1%").find("not greater than 0"), std::string::npos);
  EXPECT_NE(refusal("little").find("expected"), std::string::npos);
}

}  // namespace
}  // namespace pileus::study

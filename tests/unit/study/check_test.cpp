#include "study/check.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace pileus::study {
namespace {

namespace fs = std::filesystem;

class Check : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path touch(const std::string& name) {
    const fs::path path = folder_ / name;
    fs::create_directories(path.parent_path());
    std::ofstream file(path);
    return path;
  }

  static output::ExpectSummary expectation(double value, double low, double high) {
    output::ExpectSummary result;
    result.diagnostic = "total_energy";
    result.statistic = "relative_change";
    result.value = value;
    result.low = low;
    result.high = high;
    result.passed = value >= low && value <= high;
    result.source = "a paper, table 3";
    return result;
  }

  /// Stands for the model: every scene gives the same result.
  static Runner runner(std::vector<output::ExpectSummary> expectations) {
    return [expectations](const model::RunRequest& request, Progress&) {
      model::RunResult result;
      result.directory = request.output_directory;
      result.summary.expect = expectations;
      for (const auto& each : expectations) result.expectations_met &= each.passed;
      return result;
    };
  }

  fs::path folder_;
  SilentProgress silent_;
  std::ostringstream out_;
};

TEST_F(Check, folder_stands_for_its_small_variant_before_its_full_scene) {
  const fs::path full = touch("wave/wave.yaml");
  EXPECT_EQ(scenes_of(folder_ / "wave"), std::vector<fs::path>{full});
  const fs::path small = touch("wave/wave_small.yaml");
  EXPECT_EQ(scenes_of(folder_ / "wave"), std::vector<fs::path>{small});
  EXPECT_EQ(scenes_of((folder_ / "wave").string() + "/"), std::vector<fs::path>{small});
  EXPECT_EQ(scenes_of(full), std::vector<fs::path>{full});
}

TEST_F(Check, folder_of_other_scenes_stands_for_all_and_folder_of_folders_for_theirs) {
  const fs::path b = touch("hard/b.yaml"), a = touch("hard/a.yaml");
  touch("hard/notes.txt");
  EXPECT_EQ(scenes_of(folder_ / "hard"), (std::vector<fs::path>{a, b}));
  const fs::path wave = touch("wave/wave.yaml");
  EXPECT_EQ(scenes_of(folder_), (std::vector<fs::path>{a, b, wave}));
}

TEST_F(Check, path_without_a_scene_is_a_usage_error) {
  EXPECT_THROW(scenes_of(folder_ / "absent"), Error);
  fs::create_directories(folder_ / "empty");
  EXPECT_THROW(scenes_of(folder_ / "empty"), Error);
}

TEST_F(Check, met_bounds_pass_and_the_temporary_results_go) {
  const fs::path scene = touch("wave.yaml");
  std::string results;
  const Runner run = [&](const model::RunRequest& request, Progress& progress) {
    fs::create_directories(request.output_directory);
    results = request.output_directory;
    return runner({expectation(0.5, 0, 1)})(request, progress);
  };
  const CheckResult result = check({{scene.string()}, {}, "", 1}, silent_, out_, run);
  EXPECT_EQ(result.code(), ExitCode::done);
  EXPECT_FALSE(fs::exists(results));
  EXPECT_NE(out_.str().find("pass  total_energy relative_change"), std::string::npos);
  EXPECT_NE(out_.str().find("in [0, 1]  (a paper, table 3)"), std::string::npos);
  EXPECT_NE(out_.str().find("1 scenes, 1 passed, 0 failed; 1 expectations, 1 met, 0 missed"),
            std::string::npos)
      << out_.str();
}

TEST_F(Check, missed_bound_fails_with_the_numerical_code) {
  const fs::path scene = touch("wave.yaml");
  const CheckResult result = check({{scene.string()}, {}, (folder_ / "out").string(), 1}, silent_,
                                   out_, runner({expectation(0.5, 0, 1), expectation(2, 0, 1)}));
  EXPECT_EQ(result.code(), ExitCode::numerical);
  EXPECT_NE(out_.str().find("MISS  total_energy"), std::string::npos);
  EXPECT_NE(out_.str().find("2 expectations, 1 met, 1 missed"), std::string::npos);
  EXPECT_NE(out_.str().find((folder_ / "out").string()), std::string::npos);
}

TEST_F(Check, scene_that_expects_nothing_fails) {
  const CheckResult result =
      check({{touch("wave.yaml").string()}, {}, folder_.string(), 1}, silent_, out_, runner({}));
  EXPECT_EQ(result.code(), ExitCode::numerical);
}

TEST_F(Check, failing_scene_does_not_stop_the_next_and_gives_its_code) {
  const fs::path bad = touch("a_bad.yaml"), good = touch("b_good.yaml");
  const Runner run = [&](const model::RunRequest& request, Progress& progress) {
    if (request.scene_path == bad) throw Error(ExitCode::plugin, "no such operator");
    return runner({expectation(0.5, 0, 1)})(request, progress);
  };
  const CheckResult result =
      check({{bad.string(), good.string()}, {}, folder_.string(), 1}, silent_, out_, run);
  ASSERT_EQ(result.scenes.size(), 2u);
  EXPECT_FALSE(result.scenes[0].passed());
  EXPECT_TRUE(result.scenes[1].passed());
  EXPECT_EQ(result.code(), ExitCode::plugin);
  EXPECT_NE(out_.str().find("no such operator"), std::string::npos);
}

TEST_F(Check, stop_on_request_ends_the_list) {
  const Runner run = [&](const model::RunRequest& request, Progress& progress) {
    model::RunResult result = runner({expectation(0.5, 0, 1)})(request, progress);
    result.summary.status = output::Summary::Status::stopped;
    return result;
  };
  const CheckResult result =
      check({{touch("a.yaml").string(), touch("b.yaml").string()}, {}, folder_.string(), 1},
            silent_, out_, run);
  EXPECT_EQ(result.scenes.size(), 1u);
  EXPECT_EQ(result.code(), ExitCode::stopped);
}

TEST_F(Check, every_scene_gets_its_own_folder_the_overrides_and_the_threads) {
  std::vector<model::RunRequest> requests;
  const Runner run = [&](const model::RunRequest& request, Progress& progress) {
    requests.push_back(request);
    return runner({expectation(0.5, 0, 1)})(request, progress);
  };
  check({{touch("a.yaml").string(), touch("b.yaml").string()}, {"time.end=1 s"}, "out", 2}, silent_,
        out_, run);
  ASSERT_EQ(requests.size(), 2u);
  EXPECT_EQ(requests[0].output_directory, "out/a");
  EXPECT_EQ(requests[1].output_directory, "out/b");
  EXPECT_EQ(requests[1].overrides, std::vector<std::string>{"time.end=1 s"});
  EXPECT_EQ(requests[1].threads, 2);
}

}  // namespace
}  // namespace pileus::study

// Sweeps with members that are made up: isolation, what is run again, and what is collected.
#include "study/sweep_run.hpp"

#include <signal.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <sstream>

#include "base/signals.hpp"
#include "output/field_file.hpp"
#include "output/posix_file.hpp"
#include "output/read_fields.hpp"
#include "output/run_directory.hpp"
#include "study/sweep_slurm.hpp"
#include "study_text.hpp"

namespace pileus::study {
namespace {

namespace fs = std::filesystem;

/// Stands for `pileus run`: the energy grows by α a second; α = 0.3 breaks down, 0.4 is killed.
class MadeUpMembers {
 public:
  ProcessResult operator()(const ProcessRequest& request, const Watcher& watcher) {
    ++*count_;
    watcher(0.5);
    double alpha = 0;
    for (const std::string& setting : request.overrides)
      if (setting.starts_with("time.step.alpha=")) alpha = std::stod(setting.substr(16));
    if (alpha == 0.3) return {4, "the solution broke down\nin detail"};
    if (alpha == 0.4 && !*healed_) return {128 + SIGKILL, ""};
    std::ofstream(request.folder / "summary.json") << nlohmann::json(
        {{"diagnostics",
          {{"energy", {{"final", 1 + alpha}, {"mean", 1}, {"min", nullptr}, {"max", 2}}}}}});
    fs::remove(request.folder / "series.nc");
    output::SeriesFile series(request.folder / "series.nc", {{"energy", "m2 s-2", "energy", ""}},
                              {}, output::Start::fresh());
    series.append(0, std::vector<double>{1});
    if (alpha > 0.15) series.append(0.5 + alpha, std::vector<double>{1 + alpha * (0.5 + alpha)});
    series.append(2, std::vector<double>{1 + 2 * alpha});
    return {0, ""};
  }
  int count() const { return *count_; }
  void heal() { *healed_ = true; }

 private:
  std::shared_ptr<std::atomic<int>> count_ = std::make_shared<std::atomic<int>>(0);
  std::shared_ptr<bool> healed_ = std::make_shared<bool>(false);
};

class RunSweep : public StudyTest {
 protected:
  void SetUp() override {
    StudyTest::SetUp();
    write("cube.yaml", cube_scene + "output: {series: {every: 1 s}, profiles: {every: 0}}\n");
    request_.path = write("steps.yaml", R"(
scene: cube.yaml
product: [{key: time.step.alpha, values: [0.1, 0.2, 0.3, 0.4]}]
)");
    request_.directory = (folder_ / "out").string();
    request_.draw = false;
    request_.jobs = 2;
  }
  void TearDown() override {
    request_stop(0);
    StudyTest::TearDown();
  }

  SweepResult run(const PointRunner& runner) {
    std::ostringstream messages;
    table_.str("");
    return run_sweep(request_, {.quiet = true}, messages, table_, runner);
  }
  /// Why the sweep is refused for its folder; empty when it is not.
  std::string refusal() {
    try {
      run(MadeUpMembers());
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::file);
      return error.what();
    }
    return {};
  }
  fs::path out(const std::string& name) const { return folder_ / "out" / name; }
  std::string text_of(const std::string& name) const { return output::read_text_file(out(name)); }

  SweepRequest request_;
  std::ostringstream table_;
};

TEST_F(RunSweep, FailuresAreIsolatedReportedAndTheWorstIsTheCode) {
  MadeUpMembers members;
  const SweepResult result = run(members);
  EXPECT_EQ(static_cast<int>(result.code()), 128 + SIGKILL);
  EXPECT_EQ(result.records[0].status, MemberRecord::Status::done);
  EXPECT_EQ(result.records[2].status, MemberRecord::Status::failed);
  const std::string words = table_.str();
  EXPECT_NE(words.find("2 of 4 members done, 2 failed"), std::string::npos) << words;
  EXPECT_NE(words.find("member 0002 (alpha 0.3) failed with exit code 4:\n"
                       "    the solution broke down\n    in detail\n"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("(signal 9)"), std::string::npos) << words;
}

TEST_F(RunSweep, WhatIsDoneIsSkippedAndWhatWasKilledRunsAgain) {
  MadeUpMembers members;
  run(members);
  EXPECT_EQ(members.count(), 4);
  members.heal();
  EXPECT_EQ(run(members).code(), ExitCode::numerical);  // 0.3 would break down again
  EXPECT_EQ(members.count(), 5);
  request_.retry = true;
  run(members);
  EXPECT_EQ(members.count(), 6);
  request_.retry = false;
  request_.force = true;
  run(members);
  EXPECT_EQ(members.count(), 10);
}

TEST_F(RunSweep, AChangedMemberRunsAgain) {
  MadeUpMembers members;
  run(members);
  write("steps.yaml", R"(
scene: cube.yaml
product: [{key: time.step.alpha, values: [0.1, 0.25]}]
)");
  EXPECT_EQ(run(members).code(), ExitCode::done);
  EXPECT_EQ(members.count(), 5);
}

TEST_F(RunSweep, AStopEndsItAndTheSameCallGoesOn) {
  MadeUpMembers members;
  request_.jobs = 1;
  const auto stopped_in_the_second = [&](const ProcessRequest& request, const Watcher& watcher) {
    if (members.count() == 1) {
      std::ofstream(request.folder / "checkpoint_000000001.h5") << "a state";
      request_stop(SIGTERM);
      return ProcessResult{75, ""};
    }
    return members(request, watcher);
  };
  const SweepResult stopped = run(stopped_in_the_second);
  EXPECT_EQ(stopped.code(), ExitCode::stopped);
  EXPECT_EQ(stopped.records[1].status, MemberRecord::Status::stopped);
  EXPECT_EQ(stopped.records[2].status, MemberRecord::Status::waiting);
  EXPECT_FALSE(fs::exists(out("ensemble.nc")));
  request_stop(0);
  members.heal();
  std::vector<bool> resumed;
  run([&](const ProcessRequest& request, const Watcher& watcher) {
    resumed.push_back(request.resume);
    return members(request, watcher);
  });
  EXPECT_EQ(resumed, (std::vector<bool>{true, false, false}));  // the first goes on
  EXPECT_EQ(members.count(), 4);
  EXPECT_FALSE(fs::exists(out("members/0001/checkpoint_000000001.h5")));  // it is done
}

TEST_F(RunSweep, OneMemberRunsByItsIndexAndIsCollectedLater) {
  MadeUpMembers members;
  request_.member = 1;
  EXPECT_EQ(run(members).code(), ExitCode::done);
  EXPECT_EQ(members.count(), 1);
  EXPECT_FALSE(fs::exists(out("sweep.json")));
  request_.member.reset();
  request_.collect_only = true;
  run(members);
  EXPECT_EQ(members.count(), 1);
  const nlohmann::json list = nlohmann::json::parse(std::ifstream(out("sweep.json")));
  EXPECT_EQ(list["members"][1]["status"], "done");
  EXPECT_EQ(list["members"][0]["status"], "waiting");
  request_.collect_only = false;
  request_.member = 4;
  EXPECT_THROW(run(members), Error);
}

TEST_F(RunSweep, CollectsOnCommonTimes) {
  MadeUpMembers members;
  request_.copy = true;
  run(members);
  const output::ResultsFile file(out("ensemble.nc"));
  EXPECT_EQ(file.read("time"), (std::vector<double>{0, 1, 2}));
  const std::vector<double> energy = file.read("energy");
  ASSERT_EQ(energy.size(), 12U);
  EXPECT_DOUBLE_EQ(energy[1], 1.1);  // on the line between 0 and 2 s
  EXPECT_DOUBLE_EQ(energy[4], 1.2);
  EXPECT_TRUE(std::isnan(energy[7]));  // of the member that broke down
  EXPECT_DOUBLE_EQ(file.read("energy_mean")[1], 1.15);
  EXPECT_DOUBLE_EQ(file.read("energy_std")[2], 0.1);
  EXPECT_DOUBLE_EQ(file.read("energy_p50")[2], 1.3);
  EXPECT_EQ(file.read("alpha"), (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
}

TEST_F(RunSweep, ReportsTablesOfMembers) {
  MadeUpMembers members;
  run(members);
  std::ifstream table(out("members.csv"));
  std::string header, first;
  std::getline(table, header);
  std::getline(table, first);
  EXPECT_EQ(header,
            "member,alpha,seed,status,wall_s,energy_final,energy_mean,energy_min,energy_max");
  EXPECT_EQ(first.substr(0, 13), "0,0.1,,done,0");
  EXPECT_NE(first.find(",1.1,1,,2"), std::string::npos) << first;
  std::ifstream list(out("members.tsv"));
  std::getline(list, header);
  EXPECT_EQ(header, "index\talpha\tseed\tstatus\tsha256\twall_s");
}

TEST_F(RunSweep, AMemberThatAnotherProcessRunsIsNotTouched) {
  MadeUpMembers members;
  members.heal();
  request_.member = 0;
  run(members);
  write("out/members/0001/log.txt", "what it has written");
  write("out/members/0001/member.json", "its record");
  const output::RunDirectory held(out("members/0001"), output::RunDirectory::Mode::resume);
  request_.member = 1;
  try {
    run(members);
    FAIL() << "the member is in use";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::file);
    EXPECT_NE(std::string(error.what()).find("the folder is in use by process"), std::string::npos);
  }
  request_.member.reset();
  EXPECT_EQ(run(members).code(), ExitCode::file);  // the others are run
  EXPECT_NE(table_.str().find("2 of 4 members done, 1 failed, 1 running"), std::string::npos)
      << table_.str();
  EXPECT_NE(table_.str().find("member 0001 was left alone: "), std::string::npos);
  EXPECT_EQ(text_of("members/0001/log.txt"), "what it has written");
  EXPECT_EQ(text_of("members/0001/member.json"), "its record");
}

TEST_F(RunSweep, AMemberWithoutReadableResultsIsNotDone) {
  MadeUpMembers members;
  members.heal();
  request_.copy = true;
  run(members);
  fs::remove(out("members/0000/series.nc"));
  fs::resize_file(out("members/0003/series.nc"), fs::file_size(out("members/0003/series.nc")) / 2);
  request_.collect_only = true;
  run(members);
  EXPECT_EQ(members.count(), 4);
  const std::string words = table_.str();
  EXPECT_NE(words.find("1 of 4 members done, 1 failed, 2 waiting"), std::string::npos) << words;
  EXPECT_NE(words.find("member 0000 counts as not done: " + out("members/0000/series.nc").string() +
                       " is missing"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("member 0003 counts as not done: " + out("members/0003/series.nc").string()),
            std::string::npos)
      << words;
  EXPECT_DOUBLE_EQ(output::ResultsFile(out("ensemble.nc")).read("energy_mean")[1], 1.14);
  request_.collect_only = false;
  run(members);
  EXPECT_EQ(members.count(), 6);
  EXPECT_NE(table_.str().find("3 of 4 members done, 1 failed"), std::string::npos) << table_.str();
}

TEST_F(RunSweep, NothingOfAnEarlierCollectionStaysBesideNewTables) {
  MadeUpMembers members;
  run(members);
  const std::vector<std::string> collected = {"ensemble.nc", "steps_energy.gp", "steps_energy.svg",
                                              "steps_energy.png"};
  for (const char* name :
       {"steps_energy.gp", "steps_energy.svg", "steps_energy.png", "steps_mine.png", "notes.gp"})
    write(std::string("out/") + name, "drawn");
  write("steps.yaml", "scene: cube.yaml\nproduct: [{key: time.step.alpha, values: [0.5, 0.6]}]\n");
  request_.collect_only = true;
  run(members);
  for (const std::string& name : collected) EXPECT_FALSE(fs::exists(out(name))) << name;
  EXPECT_TRUE(fs::exists(out("steps_mine.png")));
  EXPECT_TRUE(fs::exists(out("notes.gp")));
  EXPECT_NE(table_.str().find("members: 0002, 0003 of an earlier, larger sweep"), std::string::npos)
      << table_.str();
  EXPECT_TRUE(fs::exists(out("members/0003")));
}

TEST_F(RunSweep, AFolderBelongsToOneSweep) {
  MadeUpMembers members;
  run(members);
  const std::string collected = text_of("ensemble.nc"), mine = request_.path;
  const std::string text = output::read_text_file(mine);
  request_.path = write("other/steps.yaml", "scene: ../cube.yaml\nseeds: 1\n");
  for (const bool collect_only : {false, true}) {
    request_.collect_only = collect_only;
    EXPECT_EQ(refusal(), out("").parent_path().string() +
                             ": the folder holds the sweep 'steps' of " + mine +
                             ", not 'steps' of " + request_.path +
                             ". Choose another folder with --out, or take this one over with "
                             "--force.");
  }
  request_.member = 0;
  EXPECT_NE(refusal(), "");
  EXPECT_THROW(hand_to_slurm(request_, false, table_), Error);
  request_.member.reset();
  EXPECT_EQ(text_of("ensemble.nc"), collected);
  EXPECT_EQ(members.count(), 4);
  request_.collect_only = false;
  request_.force = true;
  EXPECT_EQ(run(members).code(), ExitCode::done);
  request_.force = false;
  EXPECT_EQ(refusal(), "");
  request_.path = mine;
  EXPECT_NE(refusal(), "");
}

TEST_F(RunSweep, ASweepThatHasMovedKeepsItsFolder) {
  MadeUpMembers members;
  members.heal();
  fs::create_directories(folder_ / "a");
  for (const char* name : {"cube.yaml", "steps.yaml"})
    fs::rename(folder_ / name, folder_ / "a" / name);
  request_.path = (folder_ / "a/steps.yaml").string();
  request_.directory = (folder_ / "a/out").string();
  run(members);
  fs::copy(folder_ / "a", folder_ / "copy", fs::copy_options::recursive);
  request_.path = (folder_ / "copy/steps.yaml").string();
  request_.directory = (folder_ / "copy/out").string();
  EXPECT_EQ(refusal(), "");  // found by the way from the folder
  fs::rename(folder_ / "copy/steps.yaml", folder_ / "copy/cubes.yaml");
  request_.path = (folder_ / "copy/cubes.yaml").string();
  EXPECT_NE(refusal(), "");  // another name, and its file is gone
  write("copy/cubes.yaml", "sweep: {name: steps}\nscene: cube.yaml\nseeds: 1\n");
  EXPECT_EQ(refusal(), "");
  EXPECT_EQ(
      nlohmann::json::parse(output::read_text_file(folder_ / "copy/out/identity.json"))["file"],
      request_.path);
}

TEST_F(RunSweep, ResultsOfUnknownOriginAreNotOverwritten) {
  for (const char* name : {"ensemble.nc", "members/0000/series.nc", "members.csv"}) {
    write(std::string("out/") + name, "somebody's");
    EXPECT_NE(refusal().find("does not say of which sweep"), std::string::npos) << name;
    EXPECT_EQ(text_of(name), "somebody's");
    EXPECT_FALSE(fs::exists(out("identity.json")));
    fs::remove_all(folder_ / "out");
  }
  write("out/sweep.json", R"({"sweep": "steps"})");  // of a release without identity.json
  write("out/members/0000/member.json", "{}");
  write("out/notes.txt", "mine");
  EXPECT_EQ(refusal(), "");
}

TEST_F(RunSweep, MistakesLeaveNothingBehind) {
  write("steps.yaml", "scene: cube.yaml\nproduct: [{key: time.step.alpha, values: [-1]}]\n");
  MadeUpMembers members;
  EXPECT_THROW(run(members), Error);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(RunSweep, ABatchScriptNamesOneTaskPerMember) {
  request_.threads = 3;
  const std::string script = slurm_script(read_ensemble(request_.path), request_, "/a b/pileus",
                                          "/sweeps/it's.yaml", "/out");
  EXPECT_NE(script.find("#SBATCH --array=0-3%2\n"), std::string::npos) << script;
  EXPECT_NE(script.find("#SBATCH --cpus-per-task=3\n"), std::string::npos);
  EXPECT_NE(script.find("exec '/a b/pileus' sweep '/sweeps/it'\\''s.yaml' --out /out"),
            std::string::npos)
      << script;
}

}  // namespace
}  // namespace pileus::study

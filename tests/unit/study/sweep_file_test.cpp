// Reading sweeps: which members they have, in which order, and what is said about mistakes.
#include "study/sweep_file.hpp"

#include <cmath>
#include <set>

#include "study/sweep_members.hpp"
#include "study_text.hpp"

namespace pileus::study {
namespace {

class SweepFile : public StudyTest {
 protected:
  Ensemble ensemble_of(const std::string& text) const {
    scene::Problems problems;
    Ensemble ensemble = lay_out_members(write("sweep.yaml", "scene: cube.yaml\n" + text), problems);
    EXPECT_EQ(problems.render(), "");
    return ensemble;
  }

  std::vector<std::string> labels_of(const std::string& text) const {
    std::vector<std::string> labels;
    for (const Member& member : ensemble_of(text).members) labels.push_back(member.label);
    return labels;
  }

  /// What is wrong, with paths relative to the folder.
  std::string mistakes_of(const std::string& text) const {
    scene::Problems problems;
    lay_out_members(write("sweep.yaml", "scene: cube.yaml\n" + text), problems);
    std::string rendered = problems.render();
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at = rendered.find(prefix); at != std::string::npos;
         at = rendered.find(prefix))
      rendered.erase(at, prefix.size());
    return rendered;
  }
  std::string first_line_of(const std::string& text) const {
    const std::string words = mistakes_of(text);
    return words.substr(0, words.find('\n'));
  }
};

TEST_F(SweepFile, ProductsAreInOrderAndSeedsVaryFastest) {
  EXPECT_EQ(labels_of(R"(
product:
  - {key: time.step.alpha, values: [0.1, 0.2]}
  - {key: time.end, values: [2 s, 3 s]}
seeds: 2
)"),
            (std::vector<std::string>{"alpha 0.1, end 2 s, seed 1", "alpha 0.1, end 2 s, seed 2",
                                      "alpha 0.1, end 3 s, seed 1", "alpha 0.1, end 3 s, seed 2",
                                      "alpha 0.2, end 2 s, seed 1", "alpha 0.2, end 2 s, seed 2",
                                      "alpha 0.2, end 3 s, seed 1", "alpha 0.2, end 3 s, seed 2"}));
}

TEST_F(SweepFile, MembersHaveTheirSettingsAndTheSweeps) {
  const Ensemble ensemble = ensemble_of(R"(
set: {time.end: 5 s}
product: [{key: time.step.alpha, values: [0.1]}]
seeds: [7]
)");
  ASSERT_EQ(ensemble.members.size(), 1U);
  EXPECT_EQ(ensemble.members[0].overrides,
            (std::vector<std::string>{"time.end=5 s", "time.step.alpha=0.1", "scene.seed=7"}));
  EXPECT_NE(ensemble.members[0].resolved.find("end: 5 s"), std::string::npos);
  EXPECT_EQ(ensemble.members[0].key.size(), 64U);
}

TEST_F(SweepFile, SeedsOverrideWhatIsSetForAllMembers) {
  const Ensemble ensemble = ensemble_of("set: {scene.seed: 4}\nseeds: [7]\n");
  EXPECT_EQ(ensemble.members[0].overrides.back(), "scene.seed=7");
}

TEST_F(SweepFile, AKeyWhoseLastWordIsAColumnOfTheTablesHasItsWholeName) {
  EXPECT_EQ(labels_of("product: [{key: scene.seed, values: [7, 8]}]\n"),
            (std::vector<std::string>{"scene.seed 7", "scene.seed 8"}));
}

TEST_F(SweepFile, ListsLeaveOutWhatTheSceneHas) {
  const Ensemble ensemble = ensemble_of(R"(
list:
  - {time.step.alpha: 0.1}
  - {time.step.alpha: 0.2, time.end: 500 ms}
  - {time.end: 2 s}
)");
  ASSERT_EQ(ensemble.members.size(), 3U);
  ASSERT_EQ(ensemble.parameters.size(), 2U);
  const auto ends = numbers_of(ensemble, 1);
  ASSERT_TRUE(ends.has_value());
  EXPECT_EQ(ends->unit, "ms");  // of the first that has one
  EXPECT_TRUE(std::isnan(ends->numbers[0]));
  EXPECT_EQ(ends->numbers[1], 500);
  EXPECT_EQ(ends->numbers[2], 2000);
}

TEST_F(SweepFile, WordsAreNoNumbers) {
  const Ensemble ensemble = ensemble_of("product: [{key: time.scheme, values: [rk3, rk4]}]\n");
  EXPECT_FALSE(numbers_of(ensemble, 0).has_value());
  EXPECT_EQ(ensemble.members[1].values[0].text, "rk4");
}

TEST_F(SweepFile, SamplesLieBetweenTheirLimitsInTheLowersUnit) {
  const Ensemble ensemble = ensemble_of(R"(
sample:
  method: latin_hypercube
  count: 8
  seed: 2
  ranges:
    - {key: time.end, low: 500 ms, high: 2 s}
    - {key: time.step.alpha, low: 0.01, high: 1, scale: log}
)");
  ASSERT_EQ(ensemble.members.size(), 8U);
  std::set<int> strata, decades;
  for (const Member& member : ensemble.members) {
    EXPECT_EQ(member.values[0].unit, "ms");
    strata.insert(static_cast<int>((member.values[0].number - 500) / 1500 * 8));
    decades.insert(static_cast<int>((std::log10(member.values[1].number) + 2) * 4));
  }
  EXPECT_EQ(strata.size(), 8U);
  EXPECT_EQ(decades.size(), 8U);
}

TEST_F(SweepFile, WholeNumbersAreMetAsOften) {
  SampleRange range;
  range.low = 2;
  range.high = 4;
  range.whole = true;
  EXPECT_EQ(range.value_at(0), "2");
  EXPECT_EQ(range.value_at(0.3333), "2");
  EXPECT_EQ(range.value_at(0.3334), "3");
  EXPECT_EQ(range.value_at(0.9999), "4");
}

TEST_F(SweepFile, MembersAreKnownByWhatTheySimulate) {
  const Ensemble once = ensemble_of("product: [{key: time.step.alpha, values: [0.1, 0.2]}]\n");
  const Ensemble again =
      ensemble_of("# a comment\nproduct: [{key: time.step.alpha, values: [0.10, 0.3]}]\n");
  EXPECT_EQ(once.members[0].key, again.members[0].key);
  EXPECT_NE(once.members[1].key, again.members[1].key);
}

TEST_F(SweepFile, AllMistakesOfAllMembersAreToldAtOnce) {
  EXPECT_EQ(mistakes_of(R"(product:
  - {key: time.step.alpha, values: [0.1, -0.2]}
  - {key: time.end, values: [2 s, 3 kg]}
)"),
            "sweep.yaml:3:42: error: 'alpha' = -0.2 must be greater than 0 and at most 10 "
            "(members 0002, 0003)\n"
            "  3 |   - {key: time.step.alpha, values: [0.1, -0.2]}\n"
            "    |                                          ^~~~\n"
            "sweep.yaml:4:35: error: 'end': in '3 kg' 'kg' does not measure a time; expected a "
            "value such as '10 min' "
            "(members 0001, 0003)\n"
            "  4 |   - {key: time.end, values: [2 s, 3 kg]}\n"
            "    |                                   ^~~~");
}

TEST_F(SweepFile, MistakesOfTheSceneAreThoseOfAllMembers) {
  write("cube.yaml", "domain: {extent: 1 m, cells: [4, 4, 4]}\ntime: {end: 10 kg}\n");
  EXPECT_EQ(first_line_of("seeds: 2\n").substr(0, 16), "cube.yaml:2:13: ");
}

TEST_F(SweepFile, NamesTheNearestKey) {
  EXPECT_EQ(first_line_of("prodct: []\nseeds: 1\n"),
            "sweep.yaml:2:1: error: unknown key 'prodct' at the top level; did you mean "
            "'product'?");
  EXPECT_EQ(first_line_of("product: [{key: time.stp.alpha, values: [1]}]\n"),
            "sweep.yaml:2:11: error: unknown key 'stp' in 'time'; did you mean 'step'? "
            "(member 0000)");
  EXPECT_EQ(first_line_of("sample: {method: sobel, count: 2, ranges: [{key: time.end, low: 1, "
                          "high: 2}]}\n"),
            "sweep.yaml:2:18: error: 'method' is 'random', 'latin_hypercube' or 'sobol', found "
            "'sobel'; did you mean 'sobol'?");
}

TEST_F(SweepFile, RefusesWhatMakesNoSense) {
  const std::string range = "sample: {count: 2, ranges: [{key: time.end, ";
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {"x-note: none\n", "the sweep has no members"},
           {"seeds: 0\n", "'seeds' = 0 must be at least 1"},
           {"seeds: []\n", "sweep.yaml:2:8: error: 'seeds' needs at least one seed"},
           {"seeds: [1, 3, 1]\n", "sweep.yaml:2:15: error: the seed 1 is listed twice"},
           {"seeds: 2\nslurm: [--time=3, time=3]\n",
            "sweep.yaml:3:19: error: 'slurm' expects options of sbatch in their long form"},
           {"seeds: 2\nslurm: ['--array=0-3']\n",
            "sweep.yaml:3:9: error: the batch script sets '--array' itself"},
           {"seeds: 2\nslurm: ['--cpus-per 4']\n", "sets '--cpus-per-task' itself"},
           {"sample: {count: 2}\n", "'sample' needs 'ranges'"},
           {"product: [{key: time.end}]\n", "'product.values' is missing"},
           {"product: [{key: time.end, values: [1, 2]}, {key: time.end, values: [3]}]\n",
            "the key 'time.end' is varied twice"},
           {"product: [{key: scene.seed, values: [7, 8]}]\nseeds: 2\n",
            "sweep.yaml:3:1: error: the key 'scene.seed' is varied twice"},
           {"list: [{parcels.seed: 7}]\nseeds: 2\nseed_keys: [scene.seed, parcels.seed]\n",
            "sweep.yaml:4:1: error: the key 'parcels.seed' is varied twice"},
           {"product: [{name: status, key: time.end, values: [1, 2]}]\n",
            "sweep.yaml:2:11: error: no parameter can be called 'status'"},
           {range + "low: 2, high: 1}]}\n", "'high' has to be above 'low', 2"},
           {range + "low: 2 s, high: 3}]}\n", "either both have a unit or neither"},
           {range + "low: 2 s, high: 3 m}]}\n", "'high': 'm' does not measure a time"},
           {range + "low: 0, high: 1, scale: log}]}\n", "needs a 'low' above 0"},
           {range + "low: soon, high: 1}]}\n", "'low' expects a number"}})
    EXPECT_NE(mistakes_of(text).find(words), std::string::npos) << text << mistakes_of(text);
}

TEST_F(SweepFile, OptionsBesidesThoseOfTheScriptAreAccepted) {
  EXPECT_EQ(mistakes_of("seeds: 2\nslurm: [--ntasks-per-node=4, --comment=a -b]\n"), "");
}

TEST_F(SweepFile, RefusesNamesThatAreNoNameOfAFolder) {
  for (const char* name : {"''", "a/b", "..", ".hidden", "'../other'", "/etc", "\"a\\nb\""}) {
    const std::string words = first_line_of(std::string("sweep: {name: ") + name + "}\nseeds: 2\n");
    EXPECT_EQ(words.substr(0, 23), "sweep.yaml:2:15: error:") << name;
    EXPECT_NE(words.find("cannot be the name of a sweep"), std::string::npos) << words;
  }
  EXPECT_EQ(mistakes_of("sweep: {name: v1..2 of May}\nseeds: 2\n"), "");
}

}  // namespace
}  // namespace pileus::study

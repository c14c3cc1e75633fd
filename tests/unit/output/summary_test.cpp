#include "output/summary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "output/posix_file.hpp"
#include "support.hpp"

namespace pileus::output {
namespace {

using Json = nlohmann::json;

Summary sample_summary() {
  Summary s;
  s.scene = "moist_thermal";
  s.title = "A moist thermal";
  s.threads = 2;
  s.steps = 123;
  s.simulated_time = 360;
  s.wall = 61.25;
  s.core = 119.5;
  s.parcels_initial = 262144;
  s.parcels_final = 281002;
  s.parcels_mean = 270000.5;
  s.ns_per_parcel_step = 2412.7;
  s.bytes_per_parcel = 388;
  s.peak_memory = 131072000;
  s.phases = {{"deposit", 12.5, 0.25, 615}, {"interpolate", 30.5, 0.61, 615}, {"merge", 0, 0, 0}};
  s.diagnostics = {{"total_water", "kg", 1.0 / 3, 1.0 / 3 + 1e-16, 0.3, 0.4, 0.35, 1.5e-16},
                   {"max_liquid_water", "1", 0, NAN, 0, INFINITY, 0.1, {}}};
  const CallSummary calls{1000000, 250000, 3.25, 2, 1, 0.25, 0, 200000, 50000, 0, 0.8125};
  s.effects = {{"condensation", "on", "the scene is moist", calls},
               {"collection", "off", "it needs rain", {}}};
  s.operators = {{"saturation", calls}};
  s.left_out = {16, 1.5};
  s.budgets = {{"water", "kg", 1, 1.5, 0.5, 1e-17}};
  s.expect = {{"total_water", "relative_change", {}, 1.5e-16, {}, 1e-12, true, "round-off"},
              {"cloud_top", "max", 360.0, 4000, 2500, 3500, false, "published"}};
  s.state_sha256 = std::string(64, 'a');
  s.seeds = {{"initial", 18446744073709551615u}};
  s.version = "0.1.0";
  s.commit = "abc";
  s.compiler = "GNU 12.2";
  s.libraries = {{"HDF5", "1.10.8"}};
  s.directory = "results/moist_thermal";
  s.outputs = {{"fields.nc", "gridded fields", 7}, {"summary.json", "this summary", 0}};
  return s;
}

RunStatus sample_status() {
  RunStatus status;
  status.state = "running";
  status.scene = "moist_thermal";
  status.pid = 77;
  status.time = 90;
  status.end = 360;
  status.step = 31;
  status.dt = 2.9;
  status.parcels = 262144;
  status.wall = 15;
  return status;
}

CommandResult validate(const ScratchFolder& folder, const std::string& schema,
                       const std::string& json) {
  replace_file(folder / "value.json", json);
  return run_python(
      folder, R"py(
import json, jsonschema, sys
schema = json.load(open(sys.argv[1]))
jsonschema.Draft7Validator.check_schema(schema)
def undescribed(node, path=""):
    for name, child in node.get("properties", {}).items():
        assert child.get("description"), path + name
        for inner in (child, child.get("additionalProperties"), child.get("items")):
            if isinstance(inner, dict): undescribed(inner, path + name + ".")
undescribed(schema)
refuse = lambda name: (_ for _ in ()).throw(ValueError(name))
jsonschema.validate(json.load(open(sys.argv[2]), parse_constant=refuse), schema,
                    cls=jsonschema.Draft7Validator)
)py",
      {std::filesystem::path(PILEUS_SOURCE_DIR) / "schemas" / schema, folder / "value.json"});
}

TEST(Summary, obeys_its_schema_full_and_empty) {
  const ScratchFolder folder;
  CommandResult result = validate(folder, "summary.schema.json", to_json(sample_summary()));
  EXPECT_EQ(result.status, 0) << result.text;
  result = validate(folder, "summary.schema.json", to_json(Summary{}));
  EXPECT_EQ(result.status, 0) << result.text;
}

TEST(Summary, schema_refuses_what_is_missing_surplus_or_of_another_type) {
  const ScratchFolder folder;
  Json json = Json::parse(to_json(sample_summary()));
  Json missing = json, surplus = json, wrong = json;
  missing.erase("state_sha256");
  surplus["parcels"]["median"] = 1;
  wrong["steps"] = "123";
  for (const Json& bad : {missing, surplus, wrong})
    EXPECT_NE(validate(folder, "summary.schema.json", bad.dump()).status, 0) << bad.dump();
}

TEST(Summary, numbers_keep_every_bit_and_nan_becomes_null) {
  const Json json = Json::parse(to_json(sample_summary()));
  const Json& water = json["diagnostics"]["total_water"];
  EXPECT_EQ(water["initial"].get<double>(), 1.0 / 3);
  EXPECT_EQ(water["final"].get<double>(), 1.0 / 3 + 1e-16);
  EXPECT_EQ(water["relative_change"].get<double>(), 1.5e-16);
  const Json& liquid = json["diagnostics"]["max_liquid_water"];
  EXPECT_TRUE(liquid["final"].is_null());
  EXPECT_TRUE(liquid["max"].is_null());
  EXPECT_FALSE(liquid.contains("relative_change"));
  EXPECT_EQ(json["seeds"]["initial"].get<std::uint64_t>(), 18446744073709551615u);
  EXPECT_EQ(json["expect"][1]["bound"]["low"], 2500);
  EXPECT_TRUE(json["expect"][0]["bound"]["low"].is_null());
  EXPECT_EQ(json["expect"][1]["passed"], false);
}

TEST(Summary, times_have_to_be_numbers) {
  Summary summary = sample_summary();
  summary.wall = NAN;
  EXPECT_THROW(to_json(summary), std::invalid_argument);
}

TEST(Summary, text_that_is_not_utf8_does_not_lose_the_rest) {
  Summary summary = sample_summary();
  summary.title = "caf\xe9";
  EXPECT_EQ(Json::parse(to_json(summary))["steps"], 123);
}

TEST(Status, obeys_its_schema) {
  const ScratchFolder folder;
  const CommandResult result = validate(folder, "status.schema.json", to_json(sample_status()));
  EXPECT_EQ(result.status, 0) << result.text;
  const Json json = Json::parse(to_json(sample_status()));
  EXPECT_EQ(json["percent"], 25.0);
  EXPECT_TRUE(json["eta_s"].is_null());
}

TEST(Ledger, shows_phases_operators_conservation_judgement_and_place) {
  const std::string text = print_ledger(sample_summary());
  for (const char* part : {"moist_thermal: done at 360 s after 123 steps",
                           "262 144 -> 281 002",
                           "2413 ns",
                           "125.0 MiB",
                           "interpolate",
                           "61.0 %",
                           "saturation",
                           "250 000",
                           "condensation",
                           "on: the scene is moist",
                           "0.812",
                           "by block 200 000",
                           "done without: 16 bytes per parcel (4.1 MiB), 1.5 s",
                           "total_water",
                           "1.50e-16",
                           "FAIL  cloud_top max at 360 s = 4000",
                           "bound >= 2500 and <= 3500",
                           "results in results/moist_thermal",
                           "fields.nc",
                           "(7 records)"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  EXPECT_LT(text.find("interpolate"), text.find("deposit")) << "the costliest phase comes first";
  EXPECT_EQ(text.find("merge"), std::string::npos) << "phases that never ran are left out";
}

TEST(Ledger, does_not_price_skipped_parcels_when_none_was_called_for) {
  Summary summary = sample_summary();
  summary.operators.front().calls.seconds_saved = not_available;
  summary.left_out.seconds = not_available;
  const std::string text = print_ledger(summary);
  EXPECT_NE(text.find("n/a"), std::string::npos) << text;
  EXPECT_NE(text.find("--measure"), std::string::npos) << text;
}

TEST(Ledger, of_a_run_that_did_nothing_is_still_complete) {
  Summary summary;
  summary.scene = "empty";
  summary.status = Summary::Status::stopped;
  summary.message = "Stopped by SIGINT; continue with --resume.";
  const std::string text = print_ledger(summary);
  EXPECT_NE(text.find("empty: stopped"), std::string::npos) << text;
  EXPECT_NE(text.find("--resume"), std::string::npos);
  EXPECT_EQ(text.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace pileus::output

#include "output/read_fields.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "output/record_file.hpp"

namespace pileus::output {
namespace {

class ReadFields : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    path_ = folder_ / "fields.nc";
    const std::vector<Axis> axes = {{{"z", "m", "height"}, {0, 10}, "up"},
                                    {{"x", "m", "eastward distance"}, {0, 5, 10}}};
    RecordFile file(path_, {axes, {{"buoyancy", "m s-2", "buoyancy"}}}, {}, {}, {.exact = true},
                    Start::fresh());
    file.append(0, std::vector<std::vector<double>>{{1, 2, 3, 4, 5, 6}});
    file.append(2.5, std::vector<std::vector<double>>{{7, 8, 9, 10, 11, 12}});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_, path_;
};

TEST_F(ReadFields, variables_carry_dimensions_units_and_extent) {
  const ResultsFile file(path_);
  const StoredVariable* buoyancy = file.find("buoyancy");
  ASSERT_NE(buoyancy, nullptr);
  EXPECT_EQ(buoyancy->units, "m s-2");
  EXPECT_EQ(buoyancy->dimensions, (std::vector<std::string>{"time", "z", "x"}));
  EXPECT_EQ(buoyancy->extent, (std::vector<std::size_t>{2, 2, 3}));
  const StoredVariable* z = file.find("z");
  ASSERT_NE(z, nullptr);
  EXPECT_EQ(z->dimensions, std::vector<std::string>{"z"});
}

TEST_F(ReadFields, what_was_written_comes_back_whole_and_in_part) {
  const ResultsFile file(path_);
  EXPECT_EQ(file.read("time"), (std::vector<double>{0, 2.5}));
  EXPECT_EQ(file.read("buoyancy"), (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
  const std::vector<std::size_t> start = {1, 0, 1}, count = {1, 2, 2};
  EXPECT_EQ(file.read("buoyancy", start, count), (std::vector<double>{8, 9, 11, 12}));
}

TEST_F(ReadFields, text_variables_are_no_fields) {
  const ResultsFile file(path_);
  EXPECT_EQ(file.find("scene"), nullptr);
}

TEST_F(ReadFields, unknown_variable_and_damaged_file_are_file_errors) {
  const ResultsFile file(path_);
  try {
    file.read("no_such_thing");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::file);
    EXPECT_NE(std::string(error.what()).find("no_such_thing"), std::string::npos);
  }
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
  EXPECT_THROW(ResultsFile{path_}, Error);
  EXPECT_THROW(ResultsFile{folder_ / "absent.nc"}, Error);
}

}  // namespace
}  // namespace pileus::output

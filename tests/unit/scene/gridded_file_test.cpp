// Gridded data: what is read from HDF5 files, and how unusable files are refused.
#include "scene/gridded_file.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <filesystem>
#include <fstream>

#include "base/error.hpp"

namespace pileus::scene {
namespace {

namespace fs = std::filesystem;

/// Writes a variable, with coordinates as dimension scales where they are given.
void write_file(const std::string& path, const std::vector<hsize_t>& shape,
                const std::vector<double>& values,
                const std::vector<std::vector<double>>& coordinates = {},
                const char* units = nullptr) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5LTmake_dataset_double(file, "b", static_cast<int>(shape.size()), shape.data(), values.data());
  if (units != nullptr) H5LTset_attribute_string(file, "b", "units", units);
  const hid_t variable = H5Dopen2(file, "b", H5P_DEFAULT);
  for (std::size_t d = 0; d < coordinates.size(); ++d) {
    const std::string name = "axis" + std::to_string(d);
    const hsize_t n = coordinates[d].size();
    H5LTmake_dataset_double(file, name.c_str(), 1, &n, coordinates[d].data());
    const hid_t scale = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
    H5DSset_scale(scale, name.c_str());
    H5DSattach_scale(variable, scale, static_cast<unsigned>(d));
    H5Dclose(scale);
  }
  H5Dclose(variable);
  H5Fclose(file);
}

class GriddedFile : public testing::Test {
 protected:
  GriddedFile() {
    field_.form = FieldDescription::Form::file;
    // Tests run side by side, each in a process of its own.
    const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
    field_.path = (fs::path(testing::TempDir()) / (test + ".h5")).string();
    field_.variable = "b";
    field_.units = "m s-2";
    field_.where = {"scene.yaml", 3, 7};
    domain_.dimension = 3;
    domain_.lower = {0, 0, 0};
    domain_.extent = {4, 2, 3};
    domain_.cells = {4, 2, 3};
  }

  std::pair<ExitCode, std::string> refusal() const {
    try {
      const GriddedField data(field_, domain_);
    } catch (const Error& error) {
      return {error.code(), error.what()};
    }
    return {ExitCode::done, "accepted"};
  }

  FieldDescription field_;
  Domain domain_;
};

/// f = 10 z + y, on z = 0 … 3, y = 0, 1; x has four points with f + x (sawtooth over the period).
std::vector<double> ramp() {
  std::vector<double> values;
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 4; ++i) values.push_back(10 * k + j + i);
  return values;
}

TEST_F(GriddedFile, InterpolatesLinearlyPeriodicAndClamped) {
  write_file(field_.path, {4, 2, 4}, ramp());
  const GriddedField data(field_, domain_);
  EXPECT_DOUBLE_EQ(data(0, 0, 0), 0);
  EXPECT_DOUBLE_EQ(data(1.5, 0, 0), 1.5);
  EXPECT_DOUBLE_EQ(data(0, 0.5, 1.25), 13);
  EXPECT_DOUBLE_EQ(data(3.5, 0, 0), 1.5);   // half way from 3 back to 0
  EXPECT_DOUBLE_EQ(data(5.5, 0, 0), 1.5);   // a period on
  EXPECT_DOUBLE_EQ(data(-0.5, 0, 0), 1.5);  // and the same place from below
  EXPECT_DOUBLE_EQ(data(1, 0, -5), 1);      // below the lowest level
  EXPECT_DOUBLE_EQ(data(1, 0, 99), 31);     // above the highest
}

TEST_F(GriddedFile, TakesTheLastRecord) {
  std::vector<double> values(32, -1.0);
  const std::vector<double> last = ramp();
  values.insert(values.end(), last.begin(), last.end());
  write_file(field_.path, {2, 4, 2, 4}, values);
  EXPECT_DOUBLE_EQ(GriddedField(field_, domain_)(2, 1, 1), 13);
}

TEST_F(GriddedFile, UsesCoordinatesAndUnits) {
  write_file(field_.path, {2, 1, 2}, {0, 100, 200, 300}, {{0, 1}, {0.5}, {0, 1}}, "cm s-2");
  const GriddedField data(field_, domain_);
  EXPECT_DOUBLE_EQ(data(1, 0, 0), 1);  // 100 cm/s2 at x = 1 m, not at x = 2 m
  EXPECT_DOUBLE_EQ(data(0, 0, 0.5), 1);
  EXPECT_DOUBLE_EQ(data(2.5, 0, 0), 0.5);  // periodic: half way from 1 m to 4 m
  field_.file_units = "mm s-2";            // the scene has the last word
  EXPECT_DOUBLE_EQ(GriddedField(field_, domain_)(1, 0, 0), 0.1);
}

TEST_F(GriddedFile, ReadsTwoDimensions) {
  domain_ = {2, {0, 0}, {4, 3}, {4, 3}};
  write_file(field_.path, {2, 4}, {0, 1, 2, 3, 10, 11, 12, 13});
  EXPECT_DOUBLE_EQ(GriddedField(field_, domain_)(1, 0, 1.5), 6);
}

TEST_F(GriddedFile, RefusesMissingVariablesAndWrongRanks) {
  write_file(field_.path, {4, 2, 4}, ramp());
  field_.variable = "c";
  auto [code, text] = refusal();
  EXPECT_EQ(code, ExitCode::usage);
  EXPECT_NE(text.find("scene.yaml:3:7: error: "), std::string::npos) << text;
  EXPECT_NE(text.find("has no variable 'c'; did you mean 'b'?"), std::string::npos) << text;
  field_.variable = "b";
  write_file(field_.path, {4, 8}, ramp());
  EXPECT_EQ(refusal().first, ExitCode::usage);
  EXPECT_NE(refusal().second.find("is 4 x 8; a 3-dimensional scene takes [time,] z, y, x"),
            std::string::npos)
      << refusal().second;
}

TEST_F(GriddedFile, RefusesWrongUnitsAndCoordinates) {
  write_file(field_.path, {4, 2, 4}, ramp(), {}, "kg");
  EXPECT_NE(refusal().second.find("'kg' does not measure an acceleration"), std::string::npos);
  write_file(field_.path, {2, 1, 2}, {0, 1, 2, 3}, {{1, 0}, {0}, {0, 1}});
  EXPECT_NE(refusal().second.find("does not ascend"), std::string::npos) << refusal().second;
  write_file(field_.path, {2, 1, 2}, {0, 1, 2, 3}, {{0, 1}, {0}, {0, 9}});
  EXPECT_NE(refusal().second.find("more than the domain's period"), std::string::npos);
}

TEST_F(GriddedFile, RefusesMissingValues) {
  auto values = ramp();
  values[5] = std::numeric_limits<double>::quiet_NaN();
  write_file(field_.path, {4, 2, 4}, values);
  EXPECT_NE(refusal().second.find("missing or infinite values"), std::string::npos);
}

TEST_F(GriddedFile, TellsDamagedFilesFromWrongOnes) {
  write_file(field_.path, {4, 2, 4}, ramp());
  fs::resize_file(field_.path, fs::file_size(field_.path) / 2);
  EXPECT_EQ(refusal().first, ExitCode::file);
  EXPECT_NE(refusal().second.find("cut short or damaged"), std::string::npos) << refusal().second;
  fs::resize_file(field_.path, 0);
  EXPECT_EQ(refusal().first, ExitCode::file);
  std::ofstream(field_.path) << "CDF\x01 a classic file";
  EXPECT_EQ(refusal().first, ExitCode::usage);
  EXPECT_NE(refusal().second.find("nccopy"), std::string::npos);
  std::ofstream(field_.path) << "x,y\n1,2\n";
  EXPECT_EQ(refusal().first, ExitCode::usage);
  fs::remove(field_.path);
  EXPECT_EQ(refusal().first, ExitCode::file);
}

}  // namespace
}  // namespace pileus::scene

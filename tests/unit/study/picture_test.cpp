#include "study/picture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "base/error.hpp"

namespace pileus::study {
namespace {

class Picture : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string contents(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  static SectionPanel bubble(double height) {
    SectionPanel panel{"t = 600 s", 33, 33, 0, 6.28, 0, 6.28, {}};
    for (std::size_t k = 0; k < 33; ++k) {
      for (std::size_t i = 0; i < 33; ++i) {
        const double x = (double(i) - 16) / 8, z = (double(k) - height) / 8;
        panel.values.push_back(std::max(0.0, 1 - x * x - z * z));
      }
    }
    return panel;
  }

  std::filesystem::path folder_;
};

TEST_F(Picture, refinement_keeps_the_nodes_and_is_exact_for_a_bilinear_field) {
  SectionPanel coarse{"", 3, 2, 0, 2, 0, 1, {}};
  const auto field = [](double x, double z) { return 2 + 3 * x - z + 4 * x * z; };
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < 3; ++i) coarse.values.push_back(field(i, k));
  }
  const SectionPanel fine = refine(coarse, 4);
  ASSERT_EQ(fine.columns, 9u);
  ASSERT_EQ(fine.rows, 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    for (std::size_t i = 0; i < 9; ++i) {
      // Quarters and products of quarters are exact in binary.
      EXPECT_EQ(fine.values[k * 9 + i], field(double(i) / 4, double(k) / 4));
    }
  }
}

TEST_F(Picture, sections_become_svg_and_png) {
  SectionPicture picture{"Liquid water, y = 3.14 km",
                         "x / km",
                         "z / km",
                         "g/kg",
                         false,
                         {refine(bubble(10), 8), refine(bubble(20), 8)}};
  draw(gnuplot_script(picture), size_of(picture), folder_ / "it's a section");
  const std::string svg = contents(folder_ / "it's a section.svg");
  EXPECT_NE(svg.find("<svg"), std::string::npos);
  EXPECT_NE(svg.find("Liquid water, y = 3.14 km"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  EXPECT_EQ(contents(folder_ / "it's a section.png").substr(1, 3), "PNG");
}

TEST_F(Picture, curves_become_svg_and_png) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CurvePicture picture{"Energy",
                       "t / s",
                       "m2 s-2",
                       {{"kinetic", {0, 1, 2, 3}, {0, 1, nan, 4}}, {"potential", {0, 3}, {4, 0}}}};
  draw(gnuplot_script(picture), size_of(picture), folder_ / "energy");
  EXPECT_NE(contents(folder_ / "energy.svg").find("potential"), std::string::npos);
  EXPECT_EQ(contents(folder_ / "energy.png").substr(1, 3), "PNG");
}

TEST_F(Picture, diverging_scale_is_symmetric_about_zero) {
  SectionPicture picture{"", "", "", "", true, {{"", 2, 2, 0, 1, 0, 1, {-1, 0, 0.5, 3}}}};
  EXPECT_NE(gnuplot_script(picture).find("set cbrange [-3:3]"), std::string::npos);
}

TEST_F(Picture, a_field_constant_to_rounding_still_has_a_colour_scale) {
  SectionPicture picture{"", "",    "",
                         "", false, {{"", 2, 2, 0, 1, 0, 1, {5, 5, 5, std::nextafter(5.0, 6)}}}};
  draw(gnuplot_script(picture), size_of(picture), folder_ / "constant");
  EXPECT_EQ(contents(folder_ / "constant.png").substr(1, 3), "PNG");
}

TEST_F(Picture, gnuplots_complaint_reaches_the_user) {
  try {
    draw("plot no_such_function(x)\n", {400, 300}, folder_ / "broken");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::file);
    EXPECT_NE(std::string(error.what()).find("no_such_function"), std::string::npos)
        << error.what();
  }
}

TEST_F(Picture, missing_folder_is_a_file_error) {
  try {
    draw("plot x\n", {400, 300}, folder_ / "absent" / "picture");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::file);
  }
}

}  // namespace
}  // namespace pileus::study

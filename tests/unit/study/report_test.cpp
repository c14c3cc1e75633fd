#include "study/report.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "base/error.hpp"
#include "output/field_file.hpp"
#include "output/summary.hpp"
#include "study/report_page.hpp"
#include "study/report_pictures.hpp"

namespace pileus::study {
namespace {

namespace fs = std::filesystem;

/// A folder as a run of 4 × 2 × 2 cells leaves it, with two records.
class Report : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    using output::Start;
    const output::Axis x{{"x", "m", "horizontal distance"}, {0, 1000, 2000, 3000}};
    const output::Axis y{{"y", "m", "horizontal distance"}, {0, 2000}};
    const output::Axis z{{"z", "m", "height"}, {0, 1500, 3000}, "up"};
    output::FieldFile fields(
        folder_ / "fields.nc", {z, y, x},
        {{"buoyancy", "m s-2", "buoyancy"}, {"liquid_water", "kg kg-1", "specific liquid water"}},
        {}, {.exact = true}, Start::fresh());
    std::vector<double> buoyancy, liquid;
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 4; ++i) {
          buoyancy.push_back(100 * k + 10 * j + i - 100);
          liquid.push_back(1e-3 * (k + i));
        }
      }
    }
    const std::vector<std::vector<double>> values = {buoyancy, liquid};
    fields.append(0, values);
    fields.append(50, values);
    output::SeriesFile series(folder_ / "series.nc",
                              {{"kinetic_energy", "m2 s-2", "kinetic energy"},
                               {"volume", "1", "volume over that of the domain"},
                               {"total_energy", "m2 s-2", "total energy"}},
                              {}, Start::fresh());
    series.append(0, std::vector<double>{0, 1, 5});
    series.append(50, std::vector<double>{2, 1, 5});
    output::ProfileFile profiles(folder_ / "profiles.nc", z, {{"buoyancy", "m s-2", "buoyancy"}},
                                 {}, Start::fresh());
    profiles.append(0, std::vector<std::vector<double>>{{0, 1, 2}});
    profiles.append(50, std::vector<std::vector<double>>{{0, 2, 4}});
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  void write_summary() const {
    output::Summary summary;
    summary.title = "A bubble <dry>";
    summary.parcels_final = 128;
    summary.parcels_mean = 128;
    output::ExpectSummary missed;
    missed.diagnostic = "volume";
    missed.statistic = "final";
    missed.value = 2;
    missed.high = 1;
    summary.expect.push_back(missed);
    output::write_summary(folder_ / "summary.json", summary);
  }

  fs::path folder_;
};

TEST_F(Report, section_is_the_plane_through_the_middle_with_the_periodic_side_closed) {
  const output::ResultsFile file(folder_ / "fields.nc");
  const SectionPicture picture = section_picture(file, "buoyancy", {0});
  const SectionPanel& panel = picture.panels.at(0);
  EXPECT_EQ(panel.left, 0);
  EXPECT_EQ(panel.right, 4);  // km
  EXPECT_EQ(panel.top, 3);
  EXPECT_EQ(picture.title, "buoyancy, section at y = 2 km");
  EXPECT_EQ(picture.value_label, "m s⁻²");
  EXPECT_TRUE(picture.diverging);
  // Middle of two y indices is 1: values 10·1 + 100 k + i − 100; corners survive refinement.
  EXPECT_EQ(panel.values.front(), -90);
  EXPECT_EQ(panel.values[panel.columns - 1], -90) << "x = 4 km is x = 0 again";
  EXPECT_EQ(panel.values[(panel.rows - 1) * panel.columns], 110);
  EXPECT_EQ(panel.title, "t = 0 s");
}

TEST_F(Report, mixing_ratios_are_shown_in_grams_per_kilogram_and_first) {
  const output::ResultsFile file(folder_ / "fields.nc");
  EXPECT_EQ(gridded_fields(file), (std::vector<std::string>{"liquid_water", "buoyancy"}));
  const SectionPicture picture = section_picture(file, "liquid_water", {1});
  EXPECT_EQ(picture.value_label, "g kg⁻¹");
  EXPECT_FALSE(picture.diverging);
  // Largest value: k = 2, i = 3.
  EXPECT_NEAR(*std::max_element(picture.panels[0].values.begin(), picture.panels[0].values.end()),
              5, 4 * std::numeric_limits<double>::epsilon() * 5);
}

TEST_F(Report, series_of_one_unit_share_a_picture) {
  const output::ResultsFile file(folder_ / "series.nc");
  const auto pictures = series_pictures(file);
  ASSERT_EQ(pictures.size(), 2u);
  ASSERT_EQ(pictures[0].curves.size(), 2u);
  EXPECT_EQ(pictures[0].curves[1].label, "total energy");
  EXPECT_EQ(pictures[0].y_label, "m² s⁻²");
  EXPECT_EQ(pictures[0].curves[0].y, (std::vector<double>{0, 2}));
}

TEST_F(Report, profiles_stand_upright) {
  const output::ResultsFile file(folder_ / "profiles.nc");
  const auto pictures = profile_pictures(file);
  ASSERT_EQ(pictures.size(), 1u);
  EXPECT_EQ(pictures[0].curves.back().x, (std::vector<double>{0, 2, 4}));
  EXPECT_EQ(pictures[0].curves.back().y, (std::vector<double>{0, 1.5, 3}));
  EXPECT_EQ(pictures[0].curves.back().label, "t = 50 s");
}

TEST_F(Report, page_holds_every_picture_and_no_link_to_another_file) {
  write_summary();
  const fs::path page = write_report({folder_.string(), "", {}});
  EXPECT_EQ(page, folder_ / "report.html");
  const std::string html = contents(page);
  std::size_t pictures = 0;
  for (std::size_t at = html.find("<svg"); at != std::string::npos;
       at = html.find("<svg", at + 1)) {
    ++pictures;
  }
  EXPECT_EQ(pictures, 5u);  // two sections, two series, one profile
  EXPECT_NE(html.find("A bubble &lt;dry&gt;"), std::string::npos);
  EXPECT_NE(html.find("<td class=\"missed\">missed</td>"), std::string::npos);
  EXPECT_EQ(html.find("src="), std::string::npos);
  EXPECT_EQ(html.find("<?xml"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ / "report" / "section_liquid_water.png"));
}

TEST_F(Report, run_without_summary_still_gets_a_page) {
  EXPECT_NE(contents(write_report({folder_.string(), "buoyancy", {50}})).find("no summary yet"),
            std::string::npos);
}

TEST_F(Report, single_picture_leaves_nothing_else_behind) {
  const fs::path picture = folder_ / "pictures" / "bubble.png";
  write_section({folder_.string(), "", {0, 49}}, picture);
  EXPECT_EQ(contents(picture).substr(1, 3), "PNG");
  std::size_t entries = 0;
  for (const auto& entry : fs::directory_iterator(picture.parent_path())) {
    (void)entry;
    ++entries;
  }
  EXPECT_EQ(entries, 1u);
  EXPECT_FALSE(fs::exists(folder_ / "report.html"));
}

TEST_F(Report, wrong_requests_are_usage_errors) {
  const auto code_of = [](auto&& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.code();
    }
    return ExitCode::done;
  };
  EXPECT_EQ(code_of([&] {
              write_report({folder_.string(), "no_such_field", {}});
            }),
            ExitCode::usage);
  EXPECT_EQ(code_of([&] {
              write_report({(folder_ / "absent").string(), "", {}});
            }),
            ExitCode::usage);
  EXPECT_EQ(code_of([&] {
              write_section({folder_.string(), "", {}}, folder_ / "a.jpeg");
            }),
            ExitCode::usage);
}

TEST(pretty_units, raises_exponents_only) {
  EXPECT_EQ(pretty_units("m s-2"), "m s⁻²");
  EXPECT_EQ(pretty_units("kg m-3"), "kg m⁻³");
  EXPECT_EQ(pretty_units("1"), "");
  EXPECT_EQ(pretty_units("m2 s-2"), "m² s⁻²");
  EXPECT_EQ(pretty_units("s-12"), "s⁻¹²");
  EXPECT_EQ(pretty_units("1e-3 m"), "1e-3 m");
}

TEST(spread_records, ends_with_the_last_and_repeats_none) {
  EXPECT_EQ(spread_records(13, 4), (std::vector<std::size_t>{2, 5, 8, 12}));
  EXPECT_EQ(spread_records(2, 4), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(spread_records(1, 4), (std::vector<std::size_t>{0}));
  EXPECT_TRUE(spread_records(0, 4).empty());
}

TEST(nearest_records, picks_the_closest) {
  EXPECT_EQ(nearest_records({0, 50, 100}, {10, 26, 1000}), (std::vector<std::size_t>{0, 1, 2}));
}

}  // namespace
}  // namespace pileus::study

// Units: conversions against the definitions of the SI brochure and the refusals a scene relies on.
#include "base/units.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

namespace pileus {
namespace {

double converted(double number, const std::string& unit, const std::string& wanted) {
  const UnitConversion result = convert_units(number, unit, wanted);
  EXPECT_TRUE(result.ok()) << unit << " to " << wanted << ": " << result.problem;
  return result.value;
}

// A conversion multiplies by a factor that is itself rounded: two roundings.
void expect_equal(double value, double expected) {
  EXPECT_NEAR(value, expected, 2 * std::abs(expected) * 0x1p-52);
}

TEST(SplitQuantity, SeparatesNumberAndUnit) {
  const std::array<std::tuple<const char*, double, const char*>, 8> cases = {{
      {"33 m", 33, "m"},
      {"10min", 10, "min"},
      {"17 g/kg", 17, "g/kg"},
      {"7.2921e-5 rad/s", 7.2921e-5, "rad/s"},
      {"-0.5", -0.5, ""},
      {"+2 s", 2, "s"},
      {".5 K", 0.5, "K"},
      {"  1e3   s-1 ", 1000, "s-1"},
  }};
  for (const auto& [text, number, unit] : cases) {
    const auto split = split_quantity(text);
    ASSERT_TRUE(split) << text;
    EXPECT_EQ(split->number, number) << text;
    EXPECT_EQ(split->unit, unit) << text;
  }
}

TEST(SplitQuantity, RefusesWhatReadersDisagreeOn) {
  for (const char* text : {"", "m", "010", "-007 m", "nan", "inf", ".nan", "1_000", "1,5", "--1",
                           "+-1", "1e999", "1.5.2"})
    EXPECT_FALSE(split_quantity(text)) << text;
}

TEST(ConvertUnits, FollowsTheDefinitions) {
  expect_equal(converted(10, "min", "s"), 600);
  expect_equal(converted(17, "g/kg", "1"), 0.017);
  expect_equal(converted(-2, "K/day", "K s-1"), -2.0 / 86400);
  expect_equal(converted(7.2921e-5, "rad/s", "s-1"), 7.2921e-5);
  expect_equal(converted(1013.25, "hPa", "Pa"), 101325);
  expect_equal(converted(80, "%", "1"), 0.8);
  expect_equal(converted(100, "cm-3", "m-3"), 1e8);
  expect_equal(converted(18, "km/h", "m s-1"), 5);
  expect_equal(converted(180, "degrees", "rad"), 3.14159265358979323846);
  EXPECT_EQ(converted(0.1, "", "m"), 0.1);
}

TEST(ConvertUnits, CelsiusStatesTemperaturesOnly) {
  expect_equal(converted(20, "degC", "K"), 293.15);
  EXPECT_FALSE(convert_units(20, "degC", "K", Temperature::difference).ok());
  EXPECT_TRUE(convert_units(20, "K", "K", Temperature::difference).ok());
  EXPECT_FALSE(convert_units(1, "degC", "m").ok());
}

TEST(ConvertUnits, RefusesOtherDimensionsAndReciprocals) {
  EXPECT_FALSE(convert_units(1, "kg", "m").ok());
  EXPECT_FALSE(convert_units(10, "s", "s-1").ok());  // UDUNITS alone would say 0.1
  EXPECT_FALSE(convert_units(1, "s", "Hz").ok());
  EXPECT_FALSE(convert_units(1, "m", "1").ok());
  EXPECT_FALSE(convert_units(1, "furlogn", "m").ok());
}

TEST(ConvertUnits, SaysWhatWasFoundAndWhatIsExpected) {
  EXPECT_EQ(convert_units(1, "kg", "m").problem,
            "'kg' does not measure a length; expected a value such as '33 m'");
  EXPECT_EQ(convert_units(1, "parsecs2x", "s").problem,
            "'parsecs2x' is not a unit; expected a time such as '10 min'");
}

TEST(ToSi, GivesCoherentUnits) {
  EXPECT_DOUBLE_EQ(*to_si(2, "km"), 2000);
  EXPECT_DOUBLE_EQ(*to_si(2.5e6, "J/kg"), 2.5e6);
  EXPECT_DOUBLE_EQ(*to_si(1, "hPa"), 100);
  EXPECT_DOUBLE_EQ(*to_si(10, "g/kg"), 0.01);
  EXPECT_DOUBLE_EQ(*to_si(20, "degC"), 293.15);
  EXPECT_DOUBLE_EQ(*to_si(5, "m/s2"), 5);
  EXPECT_DOUBLE_EQ(*to_si(1, "W m-2 day"), 86400);
  EXPECT_FALSE(to_si(1, "furlogn"));
}

TEST(SameUnits, ComparesMeaningNotSpelling) {
  EXPECT_TRUE(same_units("m s-1", "m/s"));
  EXPECT_TRUE(same_units("kg kg-1", "1"));
  EXPECT_FALSE(same_units("g/kg", "1"));
  EXPECT_FALSE(same_units("K", "degC"));
  EXPECT_FALSE(same_units("m", "nonsense"));
}

TEST(Shortest, ReadsBackExactly) {
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(33), "33");
  EXPECT_EQ(with_units(0.25, "m s-2"), "0.25 m s-2");
  EXPECT_EQ(with_units(0.25, "1"), "0.25");
  for (const double value : {1.0 / 3, 1e-300, 6.02214076e23, 0.1 + 0.2, -0x1.fffffffffffffp-3})
    EXPECT_EQ(std::stod(shortest(value)), value);
}

TEST(ConvertUnits, WorksFromManyThreads) {
  std::vector<std::thread> threads;
  std::array<int, 4> right{};
  for (std::size_t t = 0; t < right.size(); ++t)
    threads.emplace_back([&right, t] {
      for (int i = 0; i < 200; ++i) right[t] += convert_units(i, "km", "m").value == 1000.0 * i;
    });
  for (std::thread& thread : threads) thread.join();
  for (const int count : right) EXPECT_EQ(count, 200);
}

}  // namespace
}  // namespace pileus

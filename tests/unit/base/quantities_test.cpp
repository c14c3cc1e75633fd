// The compiled table of quantities: units that UDUNITS knows, names that are unique.
#include "base/quantities.hpp"

#include <gtest/gtest.h>

#include <set>

#include "base/units.hpp"

namespace pileus {
namespace {

TEST(Quantities, HaveUniqueNamesKnownUnitsAndDefinitions) {
  std::set<std::string_view> names;
  for (const Quantity& quantity : quantities()) {
    EXPECT_TRUE(names.insert(quantity.name).second) << quantity.name;
    EXPECT_TRUE(is_unit(quantity.units)) << quantity.name;
    EXPECT_FALSE(quantity.symbol.empty()) << quantity.name;
    EXPECT_GT(quantity.definition.size(), 10u) << quantity.name;
  }
  EXPECT_GT(names.size(), 15u);
}

TEST(Quantities, AreFoundByName) {
  const Quantity* water = find_quantity("total_water_mass_fraction");
  ASSERT_NE(water, nullptr);
  EXPECT_EQ(water->units, "1");
  EXPECT_TRUE(water->carried);
  EXPECT_EQ(find_quantity("volume")->carried, false);
  EXPECT_EQ(find_quantity("x_vorticity")->standard_name, "");  // CF has no name for it
  EXPECT_EQ(find_quantity("nothing"), nullptr);
  EXPECT_EQ(nearest_quantity("bouyancy"), "buoyancy");
}

}  // namespace
}  // namespace pileus

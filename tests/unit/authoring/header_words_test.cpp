// The words of the plugin headers as the reference shows them.
#include "authoring/header_words.hpp"

#include <gtest/gtest.h>

#include "authoring/embedded_texts.hpp"
#include "pileus/abi.h"

namespace pileus::authoring {
namespace {

constexpr std::string_view header = R"(
enum { /* place: where it lives */
  PILEUS_PARCEL = 1,
  PILEUS_ITEM,              /* in lists that
                             * parcels own */
  PILEUS_FAR = 16u          /* last */
};
enum { PILEUS_F64 = 1, PILEUS_F32 }; /* type */
enum { PILEUS_LOG_DEBUG = 0, PILEUS_LOG_INFO };
typedef uint32_t pileus_status;
enum {
  PILEUS_OK = 0,
  PILEUS_E_NUMERIC = 19,  /* a NaN */
};
enum { PILEUS_ONE, PILEUS_OTHER };
)";

TEST(HeaderWords, enumerations_with_values_and_comments) {
  const std::vector<Enumeration> found = enumerations(header);
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0].title, "place: where it lives");
  ASSERT_EQ(found[0].enumerators.size(), 3u);
  EXPECT_EQ(found[0].enumerators[0].name, "PILEUS_PARCEL");
  EXPECT_EQ(found[0].enumerators[0].comment, "");
  EXPECT_EQ(found[0].enumerators[1].value, 2);
  EXPECT_EQ(found[0].enumerators[1].comment, "in lists that parcels own");
  EXPECT_EQ(found[0].enumerators[2].value, 16);
  EXPECT_EQ(found[0].enumerators[2].comment, "last");
}

TEST(HeaderWords, titles) {
  const std::vector<Enumeration> found = enumerations(header);
  ASSERT_EQ(found.size(), 4u);  // the last has none and is left out
  EXPECT_EQ(found[1].title, "type");
  EXPECT_EQ(found[2].title, "log");
  EXPECT_EQ(found[3].title, "status");
  EXPECT_EQ(found[3].enumerators[1].value, 19);
}

TEST(HeaderWords, those_of_the_interface) {
  const auto value_of = [all = enumerations(interface_text())](std::string_view name) {
    for (const Enumeration& one : all)
      for (const Enumerator& e : one.enumerators)
        if (e.name == name) return e.value;
    return -1L;
  };
  EXPECT_EQ(value_of("PILEUS_DOMAIN"), PILEUS_DOMAIN);
  EXPECT_EQ(value_of("PILEUS_ON_DEMAND"), PILEUS_ON_DEMAND);
  EXPECT_EQ(value_of("PILEUS_RULE_HOOK"), PILEUS_RULE_HOOK);
  EXPECT_EQ(value_of("PILEUS_SERIES"), PILEUS_SERIES);
  EXPECT_EQ(value_of("PILEUS_E_INTERNAL"), PILEUS_E_INTERNAL);
  EXPECT_EQ(value_of("PILEUS_LOG_ERROR"), PILEUS_LOG_ERROR);
  EXPECT_EQ(value_of("PILEUS_BUILT_SANITIZED"), PILEUS_BUILT_SANITIZED);
}

TEST(HeaderWords, documented_functions) {
  const auto found = documented_functions(R"(
  /// One it reads
  /// and changes.
  Quantity updates(const char* name, const char* units) {
  Quantity silent(const char* name);
  /// Of another type.
  int other(int a);
  /// Over
  void long_one(int a,
                int b) {
)",
                                          {"Quantity", "void"});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].declaration, "updates(const char* name, const char* units)");
  EXPECT_EQ(found[0].comment, "One it reads and changes.");
  EXPECT_EQ(found[1].declaration, "long_one(int a, int b)");
}

}  // namespace
}  // namespace pileus::authoring

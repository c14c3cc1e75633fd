// Calls of pileus.mesh/1 that would end the process are refused in a sentence.
#include "coupling/mesh_extension.hpp"

#include <gtest/gtest.h>

#include "base/aligned_array.hpp"
#include "base/parallel.hpp"
#include "sampled_mesh.hpp"

namespace pileus::test {
namespace {

class MeshExtensionTest : public ::testing::Test {
 protected:
  static constexpr std::size_t count = 200;

  MeshExtensionTest() {
    testing::Random random(7);
    testing::fill_randomly<3>(store_, grid_, count, grid_.domain_volume() / count, 2, random);
    mesh_.reorder();
    values_.fill(1.0);
  }
  const pileus_mesh_ext& table() const { return *extension_.table(); }
  /// The refusal of both functions, which must be the same; "" if both succeed.
  std::string refusal(std::int64_t parcels, double* const* values, std::uint32_t number,
                      double* field) const {
    pileus_error there{}, back{};
    const auto deposited = table().deposit(&table(), parcels, values, number, field, &there);
    const auto found = table().interpolate(&table(), parcels, field, values, number, &back);
    EXPECT_EQ(deposited, found);
    EXPECT_STREQ(there.text, back.text);
    EXPECT_EQ(deposited == PILEUS_OK, there.text[0] == '\0');
    return there.text;
  }
  std::string refusal_of_value(double* value) const { return refusal(count, &value, 1, field()); }
  double* field() const { return const_cast<double*>(field_.data()); }

  mesh::Grid<3> grid_{{4, 4, 4}, {0, 0, 0}, {4, 4, 4}};
  parcels::Store store_{3, {}};
  testing::SampledMesh<3> mesh_{grid_, store_, {}};
  coupling::MeshExtension extension_{mesh_, store_};
  AlignedArray<double> values_{count + 8},
      field_{grid_.nodes() * std::size_t(parcels::interpolated_width<3>) + 8};
};

TEST_F(MeshExtensionTest, TakesWhatTheContractDescribes) {
  EXPECT_EQ(refusal_of_value(values_.data()), "");
  EXPECT_EQ(refusal(count, nullptr, 0, field()), "");  // the volume alone
}

TEST_F(MeshExtensionTest, RefusesNullPointers) {
  EXPECT_NE(refusal_of_value(nullptr).find("null pointer"), std::string::npos);
  EXPECT_NE(refusal(count, nullptr, 1, field()).find("null pointer"), std::string::npos);
  double* value = values_.data();
  EXPECT_NE(refusal(count, &value, 1, nullptr).find("null pointer"), std::string::npos);
}

TEST_F(MeshExtensionTest, RefusesArraysThatVectorCodeCannotRead) {
  EXPECT_NE(refusal_of_value(values_.data() + 1).find("multiple of 64 bytes"), std::string::npos);
  double* value = values_.data();
  EXPECT_NE(refusal(count, &value, 1, field() + 1).find("multiple of 64 bytes"), std::string::npos);
}

TEST_F(MeshExtensionTest, RefusesOtherNumbersOfParcelsAndTooManyValues) {
  double* value = values_.data();
  EXPECT_NE(refusal(count - 1, &value, 1, field()).find("all parcels"), std::string::npos);
  EXPECT_NE(refusal(-1, &value, 1, field()).find("all parcels"), std::string::npos);
  const std::vector<double*> many(table().width + 1, value);
  EXPECT_NE(refusal(count, many.data(), table().width + 1, field()).find("more values"),
            std::string::npos);
}

TEST_F(MeshExtensionTest, RefusesToBeCalledInsideALoop) {
  std::string text;
  omp_set_num_threads(2);
#pragma omp parallel
  if (omp_get_thread_num() == 0) text = refusal_of_value(values_.data());
  EXPECT_NE(text.find("inside a parallel loop"), std::string::npos);
}

}  // namespace
}  // namespace pileus::test

// Drops that all merge with the same rate: N = N_0/(1 + K N_0 t/2) whatever their sizes
// (Smoluchowski 1916).
#include <gtest/gtest.h>

#include "droplet_box.hpp"

namespace pileus::superdroplets {
namespace {

TEST(ConstantKernel, number_follows_smoluchowski) {
  constexpr double merging = 5e-3;  // K N_0/2, s-1
  const ConstantKernel kernel{2.0 * merging / ShimaBox::number_density};
  for (const double dt : {1.0, 20.0}) {
    ShimaBox box(8192, 5);
    const double mass = box.moment(1);
    for (int k = 1; k <= 5; ++k) {
      box.run(kernel, 200, dt);
      EXPECT_NEAR(box.number() * (1 + merging * 200 * k), 1.0, 0.02) << dt << " " << k;
    }
    EXPECT_NEAR(box.moment(1) / mass, 1.0, 1e-12);
    EXPECT_EQ(box.did.deficit, 0.0);
  }
}

}  // namespace
}  // namespace pileus::superdroplets

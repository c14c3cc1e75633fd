// The kernels are compiled for three instruction sets: they agree to rounding, and within one of
// them a parcel's own result has the same bits however the parcels are cut into ranges.
#include <gtest/gtest.h>

#include <cstring>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "base/aligned_array.hpp"
#include "parcels/kernels.hpp"

namespace pileus::parcels {
namespace {

std::vector<const Kernels*> tables() {
  std::vector<const Kernels*> list = {&baseline::parcel_kernels};
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
      __builtin_cpu_supports("bmi2"))
    list.push_back(&avx2::parcel_kernels);
  if (list.size() == 2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"))
    list.push_back(&avx512::parcel_kernels);
  return list;
}

TEST(InstructionSets, TheChosenTableIsOneOfTheThree) {
  EXPECT_STREQ(kernels().instruction_set, chosen_instruction_set());
  EXPECT_STREQ(baseline::parcel_kernels.instruction_set, "baseline");
  EXPECT_STREQ(avx2::parcel_kernels.instruction_set, "avx2");
  EXPECT_STREQ(avx512::parcel_kernels.instruction_set, "avx512");
}

constexpr std::size_t count = 1003;  // not a multiple of eight

template <int D>
auto offsets_of(const Kernels& table) {
  return D == 3 ? table.support_offsets_3d : table.support_offsets_2d;
}
template <int D>
auto ratios_of(const Kernels& table) {
  return D == 3 ? table.axis_ratios_3d : table.axis_ratios_2d;
}
auto deposit_of(const Kernels& table, const DepositJob<3>&, bool volume) {
  return volume ? table.deposit_volume_3d : table.deposit_3d;
}
auto deposit_of(const Kernels& table, const DepositJob<2>&, bool volume) {
  return volume ? table.deposit_volume_2d : table.deposit_2d;
}

template <int D>
struct Parcels {
  static constexpr std::size_t components = D == 3 ? 6 : 2;
  static constexpr int width = mesh::DepositRecord<D>::width;
  Parcels() : store(D, {}) {
    std::array<int, D> cells;
    std::array<double, D> lower, extent;
    cells.fill(9);
    lower.fill(-1);
    extent.fill(2);
    grid = mesh::Grid<D>(cells, lower, extent);
    testing::Random random(81);
    testing::fill_randomly<D>(store, grid, count, grid.domain_volume() / count, 4, random);
  }
  /// Offsets, then a deposit in ranges of `chunk` parcels.
  std::vector<double> offsets(const Kernels& table, std::size_t chunk) const {
    std::vector<double> data(components * (count + 8), 0.0);
    double* out[components];
    const double* shape[6];
    for (std::size_t c = 0; c < components; ++c) out[c] = data.data() + c * (count + 8);
    for (int c = 0; c < store.shape_components(); ++c) shape[c] = store.shape(c);
    for (std::size_t begin = 0; begin < count; begin += chunk)
      offsets_of<D>(table)(shape, out, begin, std::min(begin + chunk, count));
    for (std::size_t c = 0; c < components; ++c) std::fill(out[c] + count, out[c] + count + 8, 0.0);
    return data;
  }
  std::vector<double> deposit(const Kernels& table, const std::vector<double>& offset,
                              std::size_t chunk, bool volume) const {
    AlignedArray<double> field(grid.nodes() * (volume ? 1 : width));
    field.fill(0);
    DepositJob<D> job{};
    job.grid = make_kernel_grid(grid);
    for (int d = 0; d < D; ++d) job.position[d] = store.position(d);
    for (std::size_t c = 0; c < components; ++c) job.offset[c] = offset.data() + c * (count + 8);
    job.volume = store.volume();
    for (int c = 0; c < store.vorticity_components(); ++c) job.value[c] = store.vorticity(c);
    job.value_count = store.vorticity_components();
    job.field = field.data();
    job.tile_count[0] = job.tile_count[1] = 1 << 30;
    for (std::size_t begin = 0; begin < count; begin += chunk) {
      job.begin = begin;
      job.end = std::min(begin + chunk, count);
      deposit_of(table, job, volume)(job);
      EXPECT_EQ(job.stray_count, 0u);
    }
    return {field.data(), field.data() + field.size()};
  }
  mesh::Grid<D> grid;
  Store store;
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}
double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

template <int D>
void expect_agreement() {
  const Parcels<D> parcels;
  const auto list = tables();
  const auto reference = parcels.offsets(*list[0], count);
  const auto field = parcels.deposit(*list[0], reference, count, false);
  const auto volume = parcels.deposit(*list[0], reference, count, true);
  double a2 = 0;
  for (const double o : reference) a2 = std::max(a2, o);
  for (const Kernels* table : list) {
    SCOPED_TRACE(table->instruction_set);
    const auto offsets = parcels.offsets(*table, count);
    // Eigenvectors err by rounding over the gap of the eigenvalues, but offsets by its square root.
    EXPECT_LT(largest_difference(offsets, reference), 1e-12 * a2);
    EXPECT_LT(largest_difference(parcels.deposit(*table, reference, count, false), field), 1e-15);
    EXPECT_LT(largest_difference(parcels.deposit(*table, reference, count, true), volume), 1e-15);
    for (const std::size_t chunk : {8ul, 64ul, 1000ul, 1024ul})
      EXPECT_TRUE(same_bits(parcels.offsets(*table, chunk), offsets)) << chunk;
    // A deposit adds up the parcels of a cell before it adds to the mesh: where a cut parts them,
    // sums of a few tens of terms of order one are made in another order.
    for (const bool alone : {false, true}) {
      const auto whole = parcels.deposit(*table, offsets, count, alone);
      EXPECT_TRUE(same_bits(parcels.deposit(*table, offsets, count, alone), whole));
      for (const std::size_t chunk : {1ul, 3ul, 8ul, 61ul, 999ul})
        EXPECT_LT(largest_difference(parcels.deposit(*table, offsets, chunk, alone), whole), 1e-15)
            << chunk;
    }
  }
}
TEST(InstructionSets, AgreeInSpace) {
  expect_agreement<3>();
}
TEST(InstructionSets, AgreeInThePlane) {
  expect_agreement<2>();
}

/// Squared axis and squared ratio against Eigen; any chunking by eights, same bits.
template <int D>
void expect_ratios() {
  const Parcels<D> parcels;
  const double* shape[6];
  for (int c = 0; c < parcels.store.shape_components(); ++c) shape[c] = parcels.store.shape(c);
  for (const Kernels* table : tables()) {
    std::vector<double> length(count + 8), ratio(count + 8), length_8(count + 8),
        ratio_8(count + 8);
    ratios_of<D> (*table)(shape, length.data(), ratio.data(), 0, count);
    for (std::size_t begin = 0; begin < count; begin += 8)
      ratios_of<D> (*table)(shape, length_8.data(), ratio_8.data(), begin,
                            std::min(begin + 8, count));
    for (std::size_t p = 0; p < count; ++p) {
      const auto values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, D, D>>(
                              testing::get_shape<D>(parcels.store, p))
                              .eigenvalues();
      EXPECT_NEAR(length[p], values(D - 1), 1e-14 * values(D - 1));
      const double exact = values(D - 1) / values(0);
      EXPECT_NEAR(ratio[p], exact, 1e-14 * exact * exact) << table->instruction_set;
      EXPECT_EQ(length[p], length_8[p]);
      EXPECT_EQ(ratio[p], ratio_8[p]);
    }
  }
}
TEST(InstructionSets, AxisRatios) {
  expect_ratios<3>();
  expect_ratios<2>();
}

/// The two displacements of the volume correction, on all tables.
template <int D, class Job, class Kernel>
std::vector<double> moved(const Parcels<D>& parcels, const double* field, Kernel kernel,
                          std::size_t chunk, Job job) {
  std::vector<double> position(D * (count + 8), 0.0);
  for (int d = 0; d < D; ++d) {
    std::copy(parcels.store.position(d), parcels.store.position(d) + count,
              position.begin() + d * static_cast<std::ptrdiff_t>(count + 8));
    job.position[d] = position.data() + static_cast<std::size_t>(d) * (count + 8);
  }
  job.grid = make_kernel_grid(parcels.grid);
  if constexpr (requires { job.gradient; })
    job.gradient = field;
  else
    job.excess = field;
  for (std::size_t begin = 0; begin < count; begin += chunk) {
    job.begin = begin;
    job.end = std::min(begin + chunk, count);
    kernel(job);
  }
  return position;
}
template <int D>
void expect_displacements() {
  const Parcels<D> parcels;
  testing::Random random(82);
  std::vector<double> field(parcels.grid.nodes() * 4);
  for (double& f : field) f = testing::uniform(random, -0.05, 0.05);
  CompressJob<D> compress{};
  compress.prefactor = 1.8;
  compress.limit = 0.5;
  for (int d = 0; d < D; ++d) compress.spacing[d] = parcels.grid.spacing[d];
  const auto run = [&](const Kernels& t, std::size_t chunk, bool pressing) {
    if constexpr (D == 3)
      return pressing ? moved(parcels, field.data(), t.compress_3d, chunk, compress)
                      : moved(parcels, field.data(), t.displace_3d, chunk, DisplaceJob<3>{});
    else
      return pressing ? moved(parcels, field.data(), t.compress_2d, chunk, compress)
                      : moved(parcels, field.data(), t.displace_2d, chunk, DisplaceJob<2>{});
  };
  for (const bool pressing : {false, true}) {
    const auto reference = run(baseline::parcel_kernels, count, pressing);
    for (const Kernels* table : tables()) {
      const auto whole = run(*table, count, pressing);
      EXPECT_LT(largest_difference(whole, reference), 1e-15);
      for (const std::size_t chunk : {1ul, 8ul, 77ul})
        EXPECT_TRUE(same_bits(run(*table, chunk, pressing), whole)) << table->instruction_set;
    }
    // Both move something; the compression keeps every parcel in its cell (dossier 9.2).
    double shift = 0;
    for (std::size_t p = 0; p < count; ++p)
      for (int d = 0; d < D; ++d) {
        const double before = parcels.store.position(d)[p],
                     after = reference[static_cast<std::size_t>(d) * (count + 8) + p];
        shift = std::max(shift, std::abs(after - before));
        if (pressing) {
          const auto cell = [&](double x) {
            return std::floor((x - parcels.grid.lower[d]) / parcels.grid.spacing[d]);
          };
          EXPECT_EQ(cell(before), cell(after));
        }
      }
    EXPECT_GT(shift, 1e-3);
  }
}
TEST(InstructionSets, Displacements) {
  expect_displacements<3>();
  expect_displacements<2>();
}

}  // namespace
}  // namespace pileus::parcels

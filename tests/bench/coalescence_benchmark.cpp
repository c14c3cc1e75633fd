// Time of collision-coalescence per superdroplet and step, on one core: the box of Shima et al.
// (2009) with 2^17 superdroplets in one cell, and the same number in small cells, beside what the
// memory of the machine delivers in the same minute.
#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "../../plugins/superdroplets/coalescence.hpp"
#include "../analytic/microphysics/droplet_box.hpp"
#include "machine_limits.hpp"

namespace {

using namespace pileus;
using namespace pileus::superdroplets;

constexpr std::size_t droplets = std::size_t{1} << 17;
constexpr int windows = 40, steps = 5;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Where the droplets of a cell lie in the columns.
enum class Storage { in_order, at_random };

/// All droplets in cells of `cell` of them, with volumes that leave the collision rate as it is.
class Cells {
 public:
  Cells(std::size_t cell, Storage storage) : box_(droplets, 1), cell_(cell) {
    // The quantiles come in order of size; which cell and which place they have is random.
    shuffle(box_.water_mass, 1);
    if (storage == Storage::at_random) shuffle(box_.items, 2);
    dry_volume_.assign(droplets, 1e-21);
    hygroscopic_volume_.assign(droplets, 0.61e-21);
  }

  /// ns per droplet and step.
  template <class Kernel>
  double window(const Kernel& kernel, const CoalescenceOptions& options, double dt) {
    const DropColumns columns{box_.multiplicity.data(), box_.water_mass.data(), dry_volume_.data(),
                              hygroscopic_volume_.data()};
    const double volume =
        ShimaBox::volume * static_cast<double>(cell_) / static_cast<double>(droplets);
    const double start = cpu_seconds();
    for (int n = 0; n < steps; ++n, ++step_) {
      for (std::size_t first = 0; first < droplets; first += cell_) {
        const std::span<const std::uint32_t> items(box_.items.data() + first, cell_);
        const auto did = coalesce(kernel, columns, items, volume, dt, DrawKey{1, 2, first, step_},
                                  options, box_.scratch);
        events += did.events;
        substeps += static_cast<std::uint64_t>(did.substeps);
      }
    }
    return (cpu_seconds() - start) / steps / static_cast<double>(droplets) * 1e9;
  }

  std::uint64_t events = 0, substeps = 0;

 private:
  template <class T>
  static void shuffle(std::vector<T>& values, std::uint64_t seed) {
    for (std::size_t i = values.size() - 1; i > 0; --i)
      std::swap(values[i], values[mix_bits(seed << 32 | i) % (i + 1)]);
  }

  ShimaBox box_;
  std::size_t cell_;
  std::vector<double> dry_volume_, hygroscopic_volume_;
  std::uint64_t step_ = 0;
};

/// `asked` is the figure to stay below, in ns; 0 where none was set.
template <class Kernel>
void measure(const char* what, const Kernel& kernel, double asked, std::size_t cell = droplets,
             Storage storage = Storage::in_order, const CoalescenceOptions& options = {},
             double dt = 1.0) {
  Cells cells(cell, storage);
  std::vector<double> times;
  for (int w = 0; w < windows; ++w) times.push_back(cells.window(kernel, options, dt));
  std::sort(times.begin(), times.end());
  const std::size_t cells_there = droplets / cell;
  const double calls = static_cast<double>(windows) * steps * static_cast<double>(cells_there);
  fmt::print("{:<52}{:>8.2f}{:>8.2f}", what, times.front(), times[windows / 2]);
  fmt::print("{:>10.2f}{:>12.5f}", static_cast<double>(cells.substeps) / calls,
             2.0 * static_cast<double>(cells.events) / (calls * static_cast<double>(cell)));
  if (asked > 0) fmt::print("   {:.2f} of {:.0f}", times.front() / asked, asked);
  fmt::print("\n");
}

}  // namespace

int main() {
  omp_set_num_threads(1);
  const double before = bench::triad_bandwidth(6);
  fmt::print("core time in ns per droplet and step, {} droplets, {} windows of {} steps\n",
             droplets, windows, steps);
  fmt::print("{:<52}{:>8}{:>8}{:>10}{:>12}   {}\n", "", "least", "median", "substeps", "coalescing",
             "least/asked");
  const FallSpeedTable table(FallSpeedScheme::beard_1976, 293.15, 101325.0);
  const TabulatedKernel geometric{GeometricKernel{}, table};
  const TabulatedKernel hall{HallKernel{}, table};
  const TabulatedKernel bott{LongKernel{}, table};
  const CoalescenceOptions undivided{std::numeric_limits<double>::infinity(), 1};
  constexpr double golovin_asked = 25, falling_asked = 45;
  measure("golovin", GolovinKernel{}, golovin_asked);
  measure("geometric", geometric, falling_asked);
  measure("hall", hall, falling_asked);
  measure("long", bott, 0);
  measure("long_polynomial", LongPolynomialKernel{}, 0);
  measure("golovin, items at random", GolovinKernel{}, golovin_asked, droplets, Storage::at_random);
  measure("hall, items at random", hall, falling_asked, droplets, Storage::at_random);
  measure("golovin, undivided steps", GolovinKernel{}, golovin_asked, droplets, Storage::in_order,
          undivided);
  measure("golovin, 10 s", GolovinKernel{}, 0, droplets, Storage::in_order, {}, 10.0);
  for (const std::size_t cell : {64u, 512u, 4096u}) {
    measure(fmt::format("golovin, cells of {}", cell).c_str(), GolovinKernel{}, 0, cell);
    measure(fmt::format("hall, cells of {}", cell).c_str(), hall, 0, cell);
    measure(fmt::format("hall, cells of {}, items at random", cell).c_str(), hall, 0, cell,
            Storage::at_random);
  }
  fmt::print("triad on one core: {:.1f} GB/s before, {:.1f} after\n", before,
             bench::triad_bandwidth(6));
  return 0;
}

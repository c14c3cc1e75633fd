// Memory bandwidth of this machine at this moment, for putting other timings into proportion.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>

#include "base/aligned_array.hpp"

namespace pileus::bench {

/// Best of `repeats` triads a = b + s·c over three arrays of 320 MB (as in STREAM), in GB/s,
/// counting 24 bytes per element; on the present number of threads.
inline double triad_bandwidth(int repeats) {
  constexpr std::size_t count = std::size_t{40} << 20;
  AlignedArray<double> a(count), b(count), c(count);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < count; ++i) {
    a[i] = 0;
    b[i] = 1;
    c[i] = 2;
  }
  double best = 1e300;
  for (int r = 0; r < repeats; ++r) {
    const auto start = std::chrono::steady_clock::now();
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < count; ++i) a[i] = b[i] + 0.5 * c[i];
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return 24.0 * static_cast<double>(count) / best * 1e-9 + (a[count / 2] > 1e300 ? 1 : 0);
}

}  // namespace pileus::bench

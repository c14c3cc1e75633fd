// What this machine can do at this moment, for putting other timings into proportion.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <limits>

#include "base/aligned_array.hpp"

namespace pileus::bench {

/// Least wall time of `repeats` calls of body, s.
template <class F>
double least_seconds(int repeats, F&& body) {
  double best = std::numeric_limits<double>::infinity();
  for (int r = 0; r < repeats; ++r) {
    const auto start = std::chrono::steady_clock::now();
    body();
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

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
  const double best = least_seconds(repeats, [&] {
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < count; ++i) a[i] = b[i] + 0.5 * c[i];
  });
  return 24.0 * static_cast<double>(count) / best * 1e-9 + (a[count / 2] > 1e300 ? 1 : 0);
}

/// Multiply–adds on values in registers: 96 independent chains, enough to hide the latency.
#if defined(__x86_64__)
__attribute__((target_clones("avx512f", "avx2,fma", "default")))
#endif
inline double
multiply_add_chains(long rounds) {
  constexpr int chains = 96;
  double x[chains];
  for (int c = 0; c < chains; ++c) x[c] = 1.0 + c;
  for (long n = 0; n < rounds; ++n)
    for (int c = 0; c < chains; ++c) x[c] = x[c] * 0.999999 + 1e-6;
  double sum = 0;
  for (const double v : x) sum += v;
  return sum;
}

/// Additions and multiplications per second of the present number of threads, in Gflop/s.
inline double arithmetic_rate(int repeats) {
  constexpr long rounds = 2'000'000;
  double sink = 0;
  int threads = 1;
  const double best = least_seconds(repeats, [&] {
    int team = 0;
    double sum = 0;
#pragma omp parallel reduction(+ : sum, team)
    {
      sum += multiply_add_chains(rounds);
      ++team;
    }
    sink += sum;
    threads = team;
  });
  return 2.0 * 96 * static_cast<double>(rounds) * threads / best * 1e-9 + (sink > 1e300 ? 1 : 0);
}

struct MachineLimits {
  double triad;       // GB/s
  double arithmetic;  // Gflop/s
};
inline MachineLimits measure_limits() {
  constexpr int repeats = 8;
  return {triad_bandwidth(repeats), arithmetic_rate(repeats)};
}

}  // namespace pileus::bench

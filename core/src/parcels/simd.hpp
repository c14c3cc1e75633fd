// Eight parcels at a time: the vector type of the kernels, for every instruction set.
//
// Included by the files in kernels/ only, each of which is compiled once per instruction set with
// PILEUS_ISA naming the namespace; nothing here may be shared between those copies.
#pragma once
#include <cstddef>
#include <cstdint>
#if defined(__AVX__)
#include <immintrin.h>
#endif

#ifndef PILEUS_ISA
#define PILEUS_ISA baseline
#endif

namespace pileus::PILEUS_ISA {

inline constexpr int lanes = 8;

typedef double Pack __attribute__((vector_size(64)));
typedef long Mask __attribute__((vector_size(64)));  // all ones where true
typedef std::int32_t IntPack __attribute__((vector_size(32)));
typedef std::uint32_t UnsignedPack __attribute__((vector_size(32)));
/// A Pack in memory that need not be aligned.
typedef double UnalignedPack __attribute__((vector_size(64), aligned(8), may_alias));

static inline Pack load(const double* p) {
  return *reinterpret_cast<const UnalignedPack*>(p);
}
static inline void store(double* p, Pack x) {
  *reinterpret_cast<UnalignedPack*>(p) = x;
}
static inline Pack broadcast(double x) {
  return Pack{x, x, x, x, x, x, x, x};
}

static inline Pack select(Mask m, Pack a, Pack b) {
  return m ? a : b;
}
static inline Pack maximum(Pack a, Pack b) {
  return a > b ? a : b;
}
static inline Pack minimum(Pack a, Pack b) {
  return a < b ? a : b;
}
static inline Pack absolute(Pack a) {
  return a < 0.0 ? -a : a;
}

static inline Pack square_root(Pack x) {
#if defined(__AVX512F__)
  return _mm512_sqrt_pd(x);
#elif defined(__AVX__)
  __m256d low = _mm256_sqrt_pd(__m256d{x[0], x[1], x[2], x[3]});
  __m256d high = _mm256_sqrt_pd(__m256d{x[4], x[5], x[6], x[7]});
  return Pack{low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]};
#else
  for (int i = 0; i < lanes; ++i) x[i] = __builtin_sqrt(x[i]);
  return x;
#endif
}

/// 1/√x for x > 0 to within two units in the last place: an estimate of 14 bits refined twice,
/// where there is one, at a third of the time of a root and a division.
static inline Pack inverse_square_root(Pack x) {
#if defined(__AVX512F__)
  Pack y = _mm512_rsqrt14_pd(x);
  for (int step = 0; step < 2; ++step) y = y + 0.5 * y * (1.0 - x * y * y);
  return y;
#else
  return 1.0 / square_root(x);
#endif
}

/// 1/x to 14 bits or better, for iterations that correct themselves.
static inline Pack rough_inverse(Pack x) {
#if defined(__AVX512F__)
  return _mm512_rcp14_pd(x);
#else
  return 1.0 / x;
#endif
}

/// Largest integer not above x, as 32-bit integers; x must lie within ±2^31.
static inline IntPack floor_to_int(Pack x) {
  const IntPack truncated = __builtin_convertvector(x, IntPack);
  const Pack back = __builtin_convertvector(truncated, Pack);
  const IntPack one_too_high = __builtin_convertvector(back > x, IntPack);  // −1 where true
  // Modulo 2^32: a value beyond the range gives some integer, not undefined behaviour.
  return reinterpret_cast<IntPack>(reinterpret_cast<UnsignedPack>(truncated) +
                                   reinterpret_cast<UnsignedPack>(one_too_high));
}
static inline Pack to_pack(IntPack i) {
  return __builtin_convertvector(i, Pack);
}

/// Does the condition hold in any lane?
static inline bool any(Mask m) {
#if defined(__AVX512F__)
  return _mm512_test_epi64_mask(reinterpret_cast<__m512i>(m), reinterpret_cast<__m512i>(m)) != 0;
#else
  long together = 0;
  for (int i = 0; i < lanes; ++i) together |= m[i];
  return together != 0;
#endif
}

// The same words for one value, so that formulas can be written once for both.
static inline double select(bool m, double a, double b) {
  return m ? a : b;
}
static inline double maximum(double a, double b) {
  return a > b ? a : b;
}
static inline double minimum(double a, double b) {
  return a < b ? a : b;
}
static inline double absolute(double a) {
  return a < 0.0 ? -a : a;
}
static inline bool any(bool m) {
  return m;
}
static inline double square_root(double a) {
  return __builtin_sqrt(a);
}
static inline double inverse_square_root(double a) {
  return 1.0 / __builtin_sqrt(a);
}
static inline double rough_inverse(double a) {
  return 1.0 / a;
}

}  // namespace pileus::PILEUS_ISA

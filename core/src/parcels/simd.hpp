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

typedef std::int32_t IntPack __attribute__((vector_size(32)));
typedef std::uint32_t UnsignedPack __attribute__((vector_size(32)));

}  // namespace pileus::PILEUS_ISA

#if defined(__AVX2__) && !defined(__AVX512F__)
#include "parcels/simd_halves.hpp"
#else
#include "parcels/simd_whole.hpp"
#endif

namespace pileus::PILEUS_ISA {

static inline Pack maximum(Pack a, Pack b) {
  return select(a > b, a, b);
}
static inline Pack minimum(Pack a, Pack b) {
  return select(a < b, a, b);
}
static inline Pack absolute(Pack a) {
  return select(a < 0.0, -a, a);
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

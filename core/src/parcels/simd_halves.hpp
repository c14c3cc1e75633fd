// The Pack of simd.hpp as two registers of AVX2. A vector type of eight doubles would live in
// memory there: every operation would load and store.
#pragma once
#include <immintrin.h>

#include "parcels/simd_pairwise.hpp"

namespace pileus::PILEUS_ISA {

typedef double Half __attribute__((vector_size(32), may_alias));
typedef long HalfMask __attribute__((vector_size(32), may_alias));  // all ones where true

struct [[gnu::may_alias]] Mask {
  HalfMask first, second;
  long operator[](std::size_t lane) const { return lane < 4 ? first[lane] : second[lane - 4]; }
};

struct [[gnu::may_alias]] Pack {
  Half first, second;
  double operator[](std::size_t lane) const { return lane < 4 ? first[lane] : second[lane - 4]; }
  double& operator[](std::size_t lane) { return reinterpret_cast<double*>(this)[lane]; }
};

static inline Pack load(const double* p) {
  return {_mm256_loadu_pd(p), _mm256_loadu_pd(p + 4)};
}
static inline void store(double* p, Pack x) {
  _mm256_storeu_pd(p, x.first);
  _mm256_storeu_pd(p + 4, x.second);
}
static inline Pack broadcast(double x) {
  const Half half = _mm256_set1_pd(x);
  return {half, half};
}

PILEUS_PAIRWISE_OPERATORS(Pack, Mask)

static inline Pack select(Mask m, Pack a, Pack b) {
  return {m.first ? a.first : b.first, m.second ? a.second : b.second};
}

static inline Pack square_root(Pack x) {
  return {_mm256_sqrt_pd(x.first), _mm256_sqrt_pd(x.second)};
}

/// Largest whole number not above x.
static inline Pack round_down(Pack x) {
  return {_mm256_floor_pd(x.first), _mm256_floor_pd(x.second)};
}
/// Largest integer not above x, as 32-bit integers; x must lie within ±2^31, other values give some
/// integer.
static inline IntPack floor_to_int(Pack x) {
  const Pack whole = round_down(x);
  const __m128i low = _mm256_cvttpd_epi32(whole.first), high = _mm256_cvttpd_epi32(whole.second);
  return reinterpret_cast<IntPack>(_mm256_set_m128i(high, low));
}
static inline Pack to_pack(IntPack i) {
  const __m256i all = reinterpret_cast<__m256i>(i);
  return {_mm256_cvtepi32_pd(_mm256_castsi256_si128(all)),
          _mm256_cvtepi32_pd(_mm256_extracti128_si256(all, 1))};
}

/// Bit per lane that holds zero.
static inline unsigned zero_lanes(IntPack i) {
  const __m256i zero = _mm256_cmpeq_epi32(reinterpret_cast<__m256i>(i), _mm256_setzero_si256());
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(zero)));
}

/// Does the condition hold in any lane?
static inline bool any(Mask m) {
  const HalfMask either = m.first | m.second;
  return _mm256_movemask_pd(reinterpret_cast<__m256d>(either)) != 0;
}

/// Transposes a 4×4 block held in four halves.
static inline void transpose(Half& a, Half& b, Half& c, Half& d) {
  const Half ab_even = _mm256_unpacklo_pd(a, b), ab_odd = _mm256_unpackhi_pd(a, b);
  const Half cd_even = _mm256_unpacklo_pd(c, d), cd_odd = _mm256_unpackhi_pd(c, d);
  a = _mm256_permute2f128_pd(ab_even, cd_even, 0x20);
  b = _mm256_permute2f128_pd(ab_odd, cd_odd, 0x20);
  c = _mm256_permute2f128_pd(ab_even, cd_even, 0x31);
  d = _mm256_permute2f128_pd(ab_odd, cd_odd, 0x31);
}

/// Transposes an 8×8 block held in eight packs: its four quarters, two of which change places.
static inline void transpose(Pack (&r)[8]) {
  transpose(r[0].first, r[1].first, r[2].first, r[3].first);
  transpose(r[0].second, r[1].second, r[2].second, r[3].second);
  transpose(r[4].first, r[5].first, r[6].first, r[7].first);
  transpose(r[4].second, r[5].second, r[6].second, r[7].second);
  for (int i = 0; i < 4; ++i) {
    const Half kept = r[i].second;
    r[i].second = r[i + 4].first;
    r[i + 4].first = kept;
  }
}

}  // namespace pileus::PILEUS_ISA

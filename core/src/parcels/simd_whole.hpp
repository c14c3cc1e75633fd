// The Pack of simd.hpp as one vector of eight: a register of AVX-512, or what the compiler makes of
// it with the narrow registers every x86-64 processor has.
#pragma once

namespace pileus::PILEUS_ISA {

typedef double Pack __attribute__((vector_size(64)));
typedef long Mask __attribute__((vector_size(64)));  // all ones where true
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

static inline Pack square_root(Pack x) {
#if defined(__AVX512F__)
  return _mm512_sqrt_pd(x);
#else
  for (int i = 0; i < lanes; ++i) x[i] = __builtin_sqrt(x[i]);
  return x;
#endif
}

/// Largest whole number not above x, as 32-bit integers; other values than x in ±2^31 give some
/// integer.
static inline IntPack floor_to_int(Pack x) {
#if defined(__AVX512F__)
  return reinterpret_cast<IntPack>(
      _mm512_cvttpd_epi32(_mm512_roundscale_pd(x, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC)));
#else
  const IntPack truncated = __builtin_convertvector(x, IntPack);
  const Pack back = __builtin_convertvector(truncated, Pack);
  const IntPack one_too_high = __builtin_convertvector(back > x, IntPack);  // −1 where true
  // Modulo 2^32: a value beyond the range gives some integer, not undefined behaviour.
  return reinterpret_cast<IntPack>(reinterpret_cast<UnsignedPack>(truncated) +
                                   reinterpret_cast<UnsignedPack>(one_too_high));
#endif
}
static inline Pack to_pack(IntPack i) {
  return __builtin_convertvector(i, Pack);
}
/// Largest whole number not above x.
static inline Pack round_down(Pack x) {
#if defined(__AVX512F__)
  return _mm512_roundscale_pd(x, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
#else
  return to_pack(floor_to_int(x));
#endif
}

/// Bit per lane that holds zero.
static inline unsigned zero_lanes(IntPack i) {
#if defined(__AVX512F__)
  const __m256i all = reinterpret_cast<__m256i>(i);
  return _mm256_testn_epi32_mask(all, all);
#else
  unsigned bits = 0;
  for (int lane = 0; lane < lanes; ++lane) bits |= unsigned(i[lane] == 0) << lane;
  return bits;
#endif
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

/// Transposes an 8×8 block held in eight packs.
static inline void transpose(Pack (&r)[8]) {
  Pack t[8];
  for (int i = 0; i < 8; i += 2) {
    t[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    t[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int i = 0; i < 8; i += 4)
    for (int k = 0; k < 2; ++k) {
      r[i + k] = __builtin_shufflevector(t[i + k], t[i + k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      r[i + k + 2] = __builtin_shufflevector(t[i + k], t[i + k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  for (int k = 0; k < 4; ++k) {
    t[k] = __builtin_shufflevector(r[k], r[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    t[k + 4] = __builtin_shufflevector(r[k], r[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
  for (int i = 0; i < 8; ++i) r[i] = t[i];
}

}  // namespace pileus::PILEUS_ISA

// Two Packs that go through a formula side by side: long chains of dependent operations then wait
// for each other's results only half as long. Bit for bit the same as one after the other.
#pragma once
#include "parcels/simd.hpp"

namespace pileus::PILEUS_ISA {

struct TwinMask {
  Mask first, second;
};
struct Twin {
  Pack first, second;
};

#define PILEUS_ARITHMETIC(OP)                          \
  static inline Twin operator OP(Twin a, Twin b) {     \
    return {a.first OP b.first, a.second OP b.second}; \
  }                                                    \
  static inline Twin operator OP(Twin a, double b) {   \
    return {a.first OP b, a.second OP b};              \
  }                                                    \
  static inline Twin operator OP(double a, Twin b) {   \
    return {a OP b.first, a OP b.second};              \
  }
#define PILEUS_COMPARISON(OP)                            \
  static inline TwinMask operator OP(Twin a, Twin b) {   \
    return {a.first OP b.first, a.second OP b.second};   \
  }                                                      \
  static inline TwinMask operator OP(Twin a, double b) { \
    return {a.first OP b, a.second OP b};                \
  }
PILEUS_ARITHMETIC(+)
PILEUS_ARITHMETIC(-)
PILEUS_ARITHMETIC(*)
PILEUS_ARITHMETIC(/)
PILEUS_COMPARISON(<)
PILEUS_COMPARISON(<=)
PILEUS_COMPARISON(>)
PILEUS_COMPARISON(>=)
#undef PILEUS_ARITHMETIC
#undef PILEUS_COMPARISON

static inline Twin operator-(Twin a) {
  return {-a.first, -a.second};
}
static inline TwinMask operator&(TwinMask a, TwinMask b) {
  return {a.first & b.first, a.second & b.second};
}

static inline Twin select(TwinMask m, Twin a, Twin b) {
  return {select(m.first, a.first, b.first), select(m.second, a.second, b.second)};
}
static inline Twin maximum(Twin a, Twin b) {
  return {maximum(a.first, b.first), maximum(a.second, b.second)};
}
static inline Twin minimum(Twin a, Twin b) {
  return {minimum(a.first, b.first), minimum(a.second, b.second)};
}
static inline Twin absolute(Twin a) {
  return {absolute(a.first), absolute(a.second)};
}
static inline Twin square_root(Twin a) {
  return {square_root(a.first), square_root(a.second)};
}
static inline Twin inverse_square_root(Twin a) {
  return {inverse_square_root(a.first), inverse_square_root(a.second)};
}
static inline Twin rough_inverse(Twin a) {
  return {rough_inverse(a.first), rough_inverse(a.second)};
}

static inline Twin load_twin(const double* p) {
  return {load(p), load(p + lanes)};
}
static inline void store(double* p, Twin x) {
  store(p, x.first);
  store(p + lanes, x.second);
}

}  // namespace pileus::PILEUS_ISA

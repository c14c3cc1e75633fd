// Two Packs that go through a formula side by side: long chains of dependent operations then wait
// for each other's results only half as long. Bit for bit the same as one after the other.
#pragma once
#include "parcels/simd.hpp"
#include "parcels/simd_pairwise.hpp"

namespace pileus::PILEUS_ISA {

struct TwinMask {
  Mask first, second;
};
struct Twin {
  Pack first, second;
};

PILEUS_PAIRWISE_OPERATORS(Twin, TwinMask)

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

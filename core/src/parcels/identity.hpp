// Identities of parcels: set at birth, unique to rounding of chance, independent of memory order.
#pragma once
#include <cstdint>

namespace pileus::parcels {

/// Finaliser of a 64-bit hash (bijective, so distinct inputs give distinct outputs).
inline std::uint64_t mix(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ull;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebull;
  x ^= x >> 31;
  return x;
}

/// Identity of the child a parcel sheds when it splits in the given step. The parent keeps its own.
inline std::uint64_t child_uid(std::uint64_t parent, std::uint64_t step) {
  return mix(parent ^ mix(step + 0x9e3779b97f4a7c15ull));
}

}  // namespace pileus::parcels

// Which small parcel merges into which: resolving chains of nearest-neighbour links into stars.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pileus::parcels {

/// A small parcel and its nearest neighbour, as indices into the parcel store.
struct Link {
  std::uint32_t from, to;
};

/// Chooses from links (one per small parcel) those to carry out, so that no parcel is both source
/// and receiver and every small parcel is one of the two, exact ties excepted. The result depends
/// on the links and their order alone: pass them sorted by parcel identity.
///
/// The rules are those of the parallel resolution of Frey, Böing and Apóstolo 2024
/// (arXiv:2408.15348): leaves merge first, chains are cut behind a receiver, isolated pairs last.
class MergeGraph {
 public:
  /// `parcels`: number of parcels in the store, for the flags.
  const std::vector<Link>& resolve(const std::vector<Link>& links, std::size_t parcels);

 private:
  bool accept_leaves(const std::vector<Link>& links);
  void settle_remaining(const std::vector<Link>& links);

  std::vector<std::uint8_t> merged_, leaf_, available_;
  std::vector<Link> kept_;
};

}  // namespace pileus::parcels

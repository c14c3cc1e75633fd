// The items of the parcels (droplets) over time, or a part of them drawn by chance.
#pragma once
#include <filesystem>
#include <vector>

#include "output/ragged_file.hpp"
#include "parcels/store.hpp"

namespace pileus::output {

/// Group `/droplets`: of every item written the parcel it belongs to, how many things it stands
/// for, its position (sideways that of its parcel's centre) and what each of its things has.
class ItemFile : private RaggedFile {
 public:
  /// Each item is written with the probability `fraction`, drawn anew at every record from the
  /// parcel's identity, the item's place in its list and the time.
  ItemFile(std::filesystem::path path, const parcels::Store& store,
           std::vector<Variable> descriptions, double fraction, Provenance provenance,
           Encoding encoding, Start start);

  /// Adds the items of the store at `time` (s).
  void append(double time, const parcels::Store& store);

  using RaggedFile::times;

 private:
  void collect(double time, const parcels::Store& store);

  double fraction_;
  std::vector<std::uint64_t> parcel_, multiplicity_;
  std::vector<std::vector<double>> positions_, columns_;
};

/// Names and units of what an ItemFile has beside positions: the multiplicity, then the columns.
std::vector<Variable> item_variables(const parcels::ItemLists& items);

}  // namespace pileus::output

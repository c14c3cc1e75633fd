// Numbers, bytes and texts under names: what checkpoints and failure bundles are made of.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/sha256.hpp"
#include "output/hdf5.hpp"

namespace pileus::output {

/// Names may hold any character but must not be empty; texts must not hold NUL.
struct NamedData {
  std::map<std::string, std::vector<double>> arrays;
  std::map<std::string, std::vector<std::uint64_t>> counters;
  std::map<std::string, std::vector<std::uint8_t>> bytes;
  std::map<std::string, std::string> texts;

  bool operator==(const NamedData&) const = default;
};

/// Digest of named items that does not depend on the order in which they come: SHA-256 over the
/// items' names and digests in the order of names.
class PayloadDigest {
 public:
  void add(const std::string& name, const void* data, std::size_t bytes);
  std::string finish_hex() const;

 private:
  std::map<std::string, std::string> items_;
};

/// Writes the data as datasets /arrays/<name>, /counters/<name>, /bytes/<name> and /texts/<name>
/// and adds them to `digest`. Slashes in names are written as %2F and per cent signs as %25.
void write_named_data(const hdf5::Session& session, const NamedData& data, PayloadDigest& digest);
NamedData read_named_data(const hdf5::Session& session, PayloadDigest& digest);

}  // namespace pileus::output

// Numbers, bytes and texts under names: what checkpoints and failure bundles are made of.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

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

/// Writes the data as datasets /arrays/<name>, /counters/<name>, /bytes/<name> and /texts/<name>.
/// Slashes in names are written as %2F and per cent signs as %25.
void write_named_data(const hdf5::Session& session, const NamedData& data);
NamedData read_named_data(const hdf5::Session& session);

}  // namespace pileus::output

// One number for a whole state: equal digests mean byte-identical runs.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "parcels/store.hpp"

namespace pileus::output {

/// SHA-256, in hexadecimal digits, of the prognostic state. The message is, in this order:
/// the text "pileus state 1", `time` (s) as float64, `step`, the dimension and the number of
/// parcels as 64-bit integers; the uids; for each state column in the store's order its name and
/// its values; for each entry of `extra` in the order of names its name, its length and its
/// values. Texts are preceded by their length as a 64-bit integer; numbers are little-endian.
/// Parcels count in the order of memory, which the model's sort makes reproducible.
std::string state_sha256(const parcels::Store& store, double time, std::uint64_t step,
                         const std::map<std::string, std::vector<double>>& extra = {});

}  // namespace pileus::output

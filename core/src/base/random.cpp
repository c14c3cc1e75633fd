#include "base/random.hpp"

#include <Random123/philox.h>

namespace pileus {

void draw_random(const DrawKey& key, std::span<double> out) {
  const auto words = philox_key(key.seed, key.stream);
  const r123::Philox4x32::key_type philox_words = {{words[0], words[1]}};
  r123::Philox4x32 generator;
  for (std::size_t i = 0; i < out.size(); i += 2) {
    const auto counter = philox_counter(key, static_cast<std::uint32_t>(i / 2));
    const auto bits = generator({{counter[0], counter[1], counter[2], counter[3]}}, philox_words);
    out[i] = open_unit_interval(bits[0], bits[1]);
    if (i + 1 < out.size()) out[i + 1] = open_unit_interval(bits[2], bits[3]);
  }
}

double draw_one(const DrawKey& key) {
  double value;
  draw_random(key, {&value, 1});
  return value;
}

}  // namespace pileus

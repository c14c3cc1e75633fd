#include "parcels/kernels.hpp"

#include <cstdlib>
#include <string_view>

namespace pileus::parcels {
namespace {

const char* choose() {
  const char* asked = std::getenv("PILEUS_INSTRUCTION_SET");
  const std::string_view wish = asked ? asked : "avx512";
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                        __builtin_cpu_supports("bmi2");
  const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f") &&
                          __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  if (wish == "avx512" && has_avx512) return "avx512";
  if (wish != "baseline" && has_avx2) return "avx2";
  return "baseline";
}

}  // namespace

const char* chosen_instruction_set() {
  static const char* const name = choose();
  return name;
}

const Kernels& kernels() {
  static const Kernels& table = [&]() -> const Kernels& {
    const std::string_view name = chosen_instruction_set();
    if (name == "avx512") return avx512::parcel_kernels;
    if (name == "avx2") return avx2::parcel_kernels;
    return baseline::parcel_kernels;
  }();
  return table;
}

}  // namespace pileus::parcels

#include "dynamics/kernels.hpp"

#include <string_view>

#include "parcels/kernels.hpp"

namespace pileus::dynamics {

const Kernels& kernels() {
  static const Kernels& table = []() -> const Kernels& {
    const std::string_view name = parcels::chosen_instruction_set();
    if (name == "avx512") return avx512::dynamics_kernels;
    if (name == "avx2") return avx2::dynamics_kernels;
    return baseline::dynamics_kernels;
  }();
  return table;
}

}  // namespace pileus::dynamics

// Whether a state is one the model may be in: parcels inside, shapes that enclose their volume,
// cells filled, and quantities that are only carried within their initial range.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/simulation.hpp"
#include "output/named_data.hpp"

namespace pileus::model {

class Soundness {
 public:
  /// `changed` names the quantities that operators may change; they are held to no range.
  Soundness(const Simulation& simulation, const std::vector<std::string>& changed);

  /// Name, units and text of every value measure() returns.
  static std::vector<std::array<std::string, 3>> outputs();
  /// The values of the present state. The first state measured is the one later ones are held to.
  std::vector<double> measure(const Simulation& simulation);

  void save(output::NamedData& data) const;
  void restore(const output::NamedData& data);

 private:
  struct Carried {
    int scalar;
    double low, high, mean;  // of the first state
  };
  struct Excess {
    double range = 0, mean = 0;
  };
  struct Filling {
    double fewest = 0, most = 0, empty = 0, outside = 0;
  };
  Filling count_by_cell(const Simulation& simulation);
  Excess excess_of_carried(const Simulation& simulation);

  std::vector<Carried> carried_;
  bool has_first_ = false;
  std::vector<std::uint32_t> count_;  // of parcels per cell
};

}  // namespace pileus::model

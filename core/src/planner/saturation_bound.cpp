#include "planner/saturation_bound.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace pileus::planner {
namespace {

constexpr double tolerance = 1e-8;    // relative, of the bound
constexpr int most_intervals = 8192;  // then the bound is left wider

/// Words of `saturation_pressure` in the order of the enumeration.
constexpr std::array<std::string_view, 5> formulas = {"bolton", "tetens", "magnus", "buck",
                                                      "murphy_koop"};

/// The word a choice stands at.
std::optional<std::string_view> word_of(const host::OperatorTable& table,
                                        const host::ParameterValues& values, const char* name) {
  const int index = table.find_parameter(name);
  if (index < 0) return std::nullopt;
  const pileus_parameter& row = table.parameters[static_cast<std::size_t>(index)];
  if (row.type != PILEUS_CHOICE || row.choices == nullptr) return std::nullopt;
  return row.choices[static_cast<std::size_t>(values.numbers()[index])];
}

/// Saturation humidity of air of one potential temperature as a function of the Exner function.
class Adiabat {
 public:
  Adiabat(const AirSaturation& air, double epsilon, double theta)
      : air_(air), epsilon_(epsilon), theta_(theta) {}

  struct End {
    double exner, pressure, vapour;  // 1, Pa, Pa
  };
  End end(double exner) const {
    return {exner, thermo::pressure_of_exner(exner, air_.kappa),
            thermo::saturation_pressure(exner * theta_, air_.formula).value};
  }
  double humidity(double vapour, double pressure) const {
    return air_.mixing_ratio
               ? thermo::saturation_mixing_ratio({vapour, 0}, pressure, epsilon_).value
               : thermo::saturation_specific_humidity({vapour, 0}, pressure, epsilon_).value;
  }
  double at(const End& end) const { return humidity(end.vapour, end.pressure); }
  /// No humidity between two ends, the second of the higher pressure, is lower.
  double below(const End& a, const End& b) const {
    return humidity(std::min(a.vapour, b.vapour), b.pressure);
  }

 private:
  const AirSaturation& air_;
  double epsilon_, theta_;
};

/// Branch and bound, the coldest interval first.
double lowest_along(const Adiabat& adiabat, Interval exner) {
  struct Part {
    Adiabat::End from, to;
  };
  std::array<Part, 64> waiting{};
  std::size_t count = 0;
  waiting[count++] = {adiabat.end(exner.low), adiabat.end(exner.high)};
  double taken = std::min(adiabat.at(waiting[0].from), adiabat.at(waiting[0].to));
  double bound = taken;
  for (int looked = 0; count > 0; ++looked) {
    const Part part = waiting[--count];
    const double below = adiabat.below(part.from, part.to);
    const double middle = 0.5 * (part.from.exner + part.to.exner);
    const bool narrow = !(middle > part.from.exner && middle < part.to.exner);
    if (!(below < taken * (1 - tolerance)) || narrow || looked >= most_intervals ||
        count + 2 > waiting.size()) {
      bound = std::min(bound, below);
      continue;
    }
    const Adiabat::End between = adiabat.end(middle);
    taken = std::min(taken, adiabat.at(between));
    waiting[count++] = {between, part.to};
    waiting[count++] = {part.from, between};
  }
  return bound;
}

}  // namespace

std::optional<AirSaturation> saturation_of(const host::OperatorTable& table,
                                           const host::ParameterValues& values) {
  const auto formula = word_of(table, values, "saturation_pressure");
  const int gas = table.find_parameter("gas_constant_dry_air"),
            heat = table.find_parameter("heat_capacity");
  if (!formula || gas < 0 || heat < 0) return std::nullopt;
  const auto* const known = std::find(formulas.begin(), formulas.end(), *formula);
  if (known == formulas.end()) return std::nullopt;
  AirSaturation air;
  air.formula = static_cast<thermo::SaturationFormula>(known - formulas.begin());
  air.kappa = values.numbers()[gas] / values.numbers()[heat];
  if (table.find_parameter("saturation_humidity") < 0) return air;
  const auto measure = word_of(table, values, "saturation_humidity");
  if (measure != "specific_humidity" && measure != "mixing_ratio") return std::nullopt;
  air.mixing_ratio = measure == "mixing_ratio";
  return air;
}

double lowest_saturation_humidity(const AirSaturation& air, double epsilon, Interval exner,
                                  Interval theta) {
  if (!(exner.low > 0 && exner.low * theta.low >= coldest_described_air)) return 0;
  const double lowest = lowest_along({air, epsilon, theta.low}, exner);
  return theta.low == theta.high
             ? lowest
             : std::min(lowest, lowest_along({air, epsilon, theta.high}, exner));
}

}  // namespace pileus::planner

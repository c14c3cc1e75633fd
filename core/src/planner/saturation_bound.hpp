// The driest saturation of air between given extrema: a rigorous lower bound, whatever the formula.
#pragma once
#include <optional>

#include "host/operator_table.hpp"
#include "host/parameter_values.hpp"
#include "pileus/thermo.hpp"

namespace pileus::planner {

/// How an operator computes the saturation humidity of air.
struct AirSaturation {
  thermo::SaturationFormula formula = thermo::SaturationFormula::bolton;
  bool mixing_ratio = false;  // vapour per mass of dry air instead of moist air
  double kappa = 0;           // R_d/c_p
};

struct Interval {
  double low = 0, high = 0;
};

/// Air colder than this is not described by the formulas of saturation, K.
inline constexpr double coldest_described_air = 100.0;

/// From an operator's parameters saturation_pressure, gas_constant_dry_air, heat_capacity and, if
/// it has it, saturation_humidity; nothing if one is missing or a word is unknown.
std::optional<AirSaturation> saturation_of(const host::OperatorTable& table,
                                           const host::ParameterValues& values);

/// A lower bound of the saturation humidity of all air with a potential temperature (K) and at an
/// Exner function between the given values; 0 if some of it is colder than the formulas describe.
///
/// At a given pressure saturation humidity grows with the vapour pressure e_s(T). That has at most
/// one extremum in T, a maximum (found by Buck's formula alone, at 1108 K), so that it is lowest at
/// an end of any interval. Intervals of the Exner function are halved until the lowest vapour
/// pressure in one, taken at its highest total pressure, is within 1e-8 of a value that air there
/// takes. Nothing is assumed of the constants: where R_d/c_p is so large that saturation humidity
/// grows with height, the bound is that of the air below.
double lowest_saturation_humidity(const AirSaturation& air, double epsilon, Interval exner,
                                  Interval theta);

}  // namespace pileus::planner

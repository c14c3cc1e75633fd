// An operator's parameters: what a plugin declares, checked against what the scene says.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "scene/problems.hpp"
#include "scene/scene.hpp"
#include "scene/value.hpp"

namespace pileus::scene {

enum class ParameterType { number, integer, toggle, choice, text, numbers, profile, series };

/// One parameter as its plugin declares it.
struct ParameterDeclaration {
  std::string name = {};
  ParameterType type = ParameterType::number;
  std::string units = "1";  // UDUNITS
  std::string doc = {};
  double fallback = 0;                    // number, integer, toggle (0 or 1), the one of numbers
  double low = 0, high = 0;               // both ends included; equal: unbounded
  std::vector<std::string> choices = {};  // choice; the first is the default
  std::string text_fallback = {};         // text
  std::string when = {};                  // "thermodynamics == real"; empty: always
};

/// The values of all declared parameters, by their position in the declarations.
struct ParameterValues {
  std::vector<double> number;             // numbers, integers, switches, index of the choice
  std::vector<std::string> text;          // text and choices as words
  std::vector<std::vector<double>> list;  // numbers; of functions x0, v0, x1, v1 …
  std::vector<bool> given;                // stated by the scene
};

/// Checks the parameters of an operator's block and fills in defaults. Numbers may have units and
/// be formulas of the scene's constants. Every mistake is added to `problems` with its place.
ParameterValues validate_parameters(const OperatorBlock& block,
                                    std::span<const ParameterDeclaration> declared,
                                    const Constants& constants, Problems& problems);

/// Whether comparisons such as "ice == true and thermodynamics != ideal" hold for these values; an
/// empty condition holds.
bool condition_holds(const std::string& condition, std::span<const ParameterDeclaration> declared,
                     const ParameterValues& values);

}  // namespace pileus::scene

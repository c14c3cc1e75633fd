// Formulas in scenes: muParser with the names a scene may use, and messages with a place.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pileus::scene {

/// Why a text is not a formula, and where in it (bytes from its start).
struct FormulaProblem {
  std::string text;
  std::size_t position = 0;
};

/// A compiled formula of named variables and constants. Evaluating changes the object: one copy per
/// thread.
///
/// Beside muParser's functions (sqrt, exp, ln, log10, sin … atanh, abs, sign, min, max, rint) and
/// operators (+ − * / ^, comparisons, && ||, a ? b : c) there are if(c, a, b), clip(a, low, high),
/// step(a) (1 for a ≥ 0, else 0), mod(a, b), floor(a), ceil(a), saturation_pressure(T) over liquid
/// water (Pa of K; Bolton 1980) and the constant pi.
class Formula {
 public:
  /// Throws FormulaProblem.
  Formula(std::string text, std::vector<std::string> variables,
          const std::map<std::string, double>& constants);
  Formula(const Formula& other);
  Formula(Formula&&) noexcept;
  Formula& operator=(const Formula& other);
  Formula& operator=(Formula&&) noexcept;
  ~Formula();

  /// Its value; `values` are those of the variables, in their order. A domain error (square root of
  /// a negative number, division by zero) yields NaN or infinity, never an exception.
  double operator()(const double* values);

  /// Whether the variable of this index occurs in it.
  bool uses(std::size_t variable) const;
  const std::string& text() const;

 private:
  struct Compiled;
  std::unique_ptr<Compiled> compiled_;
};

/// Nothing when the text is a formula of these names, else what is wrong.
std::optional<FormulaProblem> check_formula(const std::string& text,
                                            const std::vector<std::string>& variables,
                                            const std::map<std::string, double>& constants);

/// Whether a word can name a constant or formula: letters, digits, underscores, and not taken by a
/// function, pi or a coordinate.
bool is_free_name(std::string_view word);

}  // namespace pileus::scene

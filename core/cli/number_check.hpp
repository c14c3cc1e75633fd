// What the command line asks of a number, in words.
#pragma once
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <string>

namespace pileus::cli {

/// Refuses what `fits` does not hold for; the library's own checks print the largest double in
/// full where a range has no upper end. `expected` completes "expected …".
template <class Fits>
CLI::Validator number_check(const std::string& expected, Fits fits) {
  return CLI::Validator(
      [expected, fits](const std::string& text) {
        char* end = nullptr;
        const double number = std::strtod(text.c_str(), &end);
        const bool whole = !text.empty() && *end == '\0';
        return whole && fits(number) ? std::string()
                                     : "expected " + expected + ", found '" + text + "'";
      },
      "");
}

inline CLI::Validator above_zero() {
  return number_check("a number above 0", [](double x) { return x > 0; });
}
inline CLI::Validator not_negative() {
  return number_check("a number from 0 on", [](double x) { return x >= 0; });
}

}  // namespace pileus::cli

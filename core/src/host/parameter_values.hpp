// The values of an operator's parameters, in the form the plugin receives them.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/operator_table.hpp"

namespace pileus::host {

/// One value per declared parameter; starts with the declared defaults.
class ParameterValues {
 public:
  explicit ParameterValues(const OperatorTable& table);

  /// Integers, switches (0 or 1) and choices (position of the word) are numbers too.
  void set_number(int index, double value) { number_[at(index)] = value; }
  void set_choice(int index, int position, const std::string& word);
  void set_text(int index, std::string value);
  void set_list(int index, std::vector<double> values);

  const double* numbers() const { return number_.data(); }
  const std::string& text(int index) const { return text_[at(index)]; }
  const std::vector<double>& list(int index) const { return list_[at(index)]; }

  /// The record handed to `configure`; valid until the next change.
  const pileus_values& view();

 private:
  static std::size_t at(int index) { return static_cast<std::size_t>(index); }

  std::vector<double> number_;
  std::vector<std::string> text_;
  std::vector<bool> has_text_, has_list_, is_function_;
  std::vector<std::vector<double>> list_;
  std::vector<const char*> text_view_;
  std::vector<const double*> list_view_;
  std::vector<std::int64_t> list_count_;
  pileus_values view_{};
};

}  // namespace pileus::host

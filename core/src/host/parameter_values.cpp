#include "host/parameter_values.hpp"

#include <utility>

namespace pileus::host {

namespace {

bool is_function(std::uint32_t type) {
  return type == PILEUS_PROFILE || type == PILEUS_SERIES;
}
bool is_list(std::uint32_t type) {
  return type == PILEUS_NUMBERS || is_function(type);
}

/// A function of one point is constant, wherever that point is.
std::vector<double> default_list(const pileus_parameter& p) {
  if (is_function(p.type)) return {0.0, p.fallback};
  if (is_list(p.type)) return {p.fallback};
  return {};
}

}  // namespace

ParameterValues::ParameterValues(const OperatorTable& table) {
  for (const pileus_parameter& p : table.parameters) {
    number_.push_back(p.type == PILEUS_CHOICE || p.type == PILEUS_TEXT ? 0.0 : p.fallback);
    has_text_.push_back(p.type == PILEUS_TEXT || p.type == PILEUS_CHOICE);
    text_.emplace_back(p.type == PILEUS_CHOICE                               ? p.choices[0]
                       : p.type == PILEUS_TEXT && p.text_fallback != nullptr ? p.text_fallback
                                                                             : "");
    has_list_.push_back(is_list(p.type));
    is_function_.push_back(is_function(p.type));
    list_.push_back(default_list(p));
  }
}

void ParameterValues::set_choice(int index, int position, const std::string& word) {
  number_[at(index)] = position;
  text_[at(index)] = word;
}

void ParameterValues::set_text(int index, std::string value) {
  text_[at(index)] = std::move(value);
}

void ParameterValues::set_list(int index, std::vector<double> values) {
  // Of a function its first value; the list begins with the place of that.
  const std::size_t first = is_function_[at(index)] ? 1 : 0;
  number_[at(index)] = values.size() <= first ? 0.0 : values[first];
  list_[at(index)] = std::move(values);
}

const pileus_values& ParameterValues::view() {
  const std::size_t count = number_.size();
  text_view_.assign(count, nullptr);
  list_view_.assign(count, nullptr);
  list_count_.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    if (has_text_[i]) text_view_[i] = text_[i].c_str();
    if (has_list_[i]) {
      list_view_[i] = list_[i].data();
      list_count_[i] = static_cast<std::int64_t>(list_[i].size());
    }
  }
  view_ = {sizeof(pileus_values), static_cast<std::uint32_t>(count),
           number_.data(),        text_view_.data(),
           list_view_.data(),     list_count_.data()};
  return view_;
}

}  // namespace pileus::host

#include "coupling/surface_fields.hpp"

#include <fmt/format.h>

#include "base/error.hpp"

namespace pileus::coupling {
namespace {

std::string stored_name(const SurfaceQuantity& quantity) {
  return "surface/" + quantity.name;
}

}  // namespace

int SurfaceFields::find(std::string_view name) const {
  for (std::size_t i = 0; i < list_.size(); ++i)
    if (list_[i].name == name) return static_cast<int>(i);
  return -1;
}

void SurfaceFields::start(std::size_t columns) {
  columns_ = columns;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    if (given_[i].size() == columns)
      values_[i] = given_[i];
    else
      values_[i].assign(columns, list_[i].initial);
  }
}

std::map<std::string, std::vector<double>> SurfaceFields::named_values() const {
  std::map<std::string, std::vector<double>> named;
  for (std::size_t i = 0; i < list_.size(); ++i) named[stored_name(list_[i])] = values_[i];
  return named;
}

void SurfaceFields::restore(const std::map<std::string, std::vector<double>>& named) {
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const auto found = named.find(stored_name(list_[i]));
    if (found == named.end() || found->second.size() != columns_)
      throw Error(ExitCode::usage,
                  fmt::format("The checkpoint does not hold the {} of {} columns of cells, which "
                              "an operator of the scene declares.",
                              list_[i].name, columns_));
    values_[i] = found->second;
  }
}

}  // namespace pileus::coupling

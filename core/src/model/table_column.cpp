#include "model/table_column.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

#include "base/error.hpp"

namespace pileus::model {
namespace {

std::vector<std::string> split_row(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream row(line);
  for (std::string cell; std::getline(row, cell, ',');) {
    while (!cell.empty() && (cell.back() == '\r' || cell.back() == ' ')) cell.pop_back();
    cells.push_back(cell.substr(std::min(cell.find_first_not_of(' '), cell.size())));
  }
  return cells;
}

}  // namespace

std::vector<double> read_table_column(const std::string& path, const std::string& column,
                                      const std::string& cited_at) {
  const auto refuse = [&](const std::string& why) {
    throw Error(ExitCode::usage, fmt::format("{}: error: {}", cited_at, why));
  };
  std::ifstream file(path);
  if (!file) refuse(fmt::format("cannot read the table '{}'.", path));
  std::vector<double> values;
  std::size_t index = 0;
  bool has_header = false;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string> cells = split_row(line);
    if (!has_header) {
      has_header = true;
      index =
          static_cast<std::size_t>(std::find(cells.begin(), cells.end(), column) - cells.begin());
      if (index == cells.size())
        refuse(fmt::format("'{}' has no column '{}'; it has {}.", path, column,
                           fmt::join(cells, ", ")));
      continue;
    }
    if (index >= cells.size()) continue;
    const std::string& cell = cells[index];
    double value = 0;
    const auto [end, status] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (status != std::errc() || end != cell.data() + cell.size())
      refuse(
          fmt::format("{}:{}: '{}' in column '{}' is not a number.", path, number, cell, column));
    values.push_back(value);
  }
  return values;
}

}  // namespace pileus::model

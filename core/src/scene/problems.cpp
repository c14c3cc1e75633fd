#include "scene/problems.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "base/error.hpp"

namespace pileus::scene {

void Problems::add(const Location& where, std::string text, int width) {
  problems_.push_back({where, std::move(text), width, {}, {}});
}

void Problems::remember_source(const std::string& file, std::string_view text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    std::size_t end = text.find('\n', begin);
    if (end == std::string_view::npos) end = text.size();
    std::string line(text.substr(begin, end - begin));
    if (!line.empty() && line.back() == '\r') line.pop_back();
    lines.push_back(std::move(line));
    begin = end + 1;
  }
  if (sources_.emplace(file, std::move(lines)).second) order_.push_back(file);
}

std::string Problems::excerpt(const Location& where, int width) const {
  const auto source = sources_.find(where.file);
  if (source == sources_.end() || where.line < 1 ||
      where.line > static_cast<int>(source->second.size()))
    return {};
  const std::string& line = source->second[static_cast<std::size_t>(where.line - 1)];
  // Tabs are repeated under the line, so that the caret stands where the terminal puts the text.
  std::string padding;
  int column = 1;
  for (const char c : line) {
    if (column >= where.column) break;
    if ((static_cast<unsigned char>(c) & 0xC0U) == 0x80U) continue;  // inside a UTF-8 character
    padding += c == '\t' ? '\t' : ' ';
    ++column;
  }
  const std::string number = std::to_string(where.line);
  const std::string tail(static_cast<std::size_t>(std::max(0, width - 1)), '~');
  return fmt::format("\n  {} | {}\n  {} | {}^{}", number, line, std::string(number.size(), ' '),
                     padding, tail);
}

std::string Problems::render() const {
  std::vector<const Problem*> sorted;
  for (const Problem& problem : problems_) sorted.push_back(&problem);
  const auto key = [&](const Problem* p) {
    const auto place = std::find(order_.begin(), order_.end(), p->where.file) - order_.begin();
    return std::make_tuple(place, p->where.line, p->where.column);
  };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const Problem* a, const Problem* b) { return key(a) < key(b); });
  std::string text;
  for (const Problem* problem : sorted) {
    if (!text.empty()) text += '\n';
    text += fmt::format("{}: error: {}", describe(problem->where), problem->text);
    text += excerpt(problem->where, problem->width);
    if (!problem->other.file.empty()) {
      text += fmt::format("\n{}: note: {}", describe(problem->other), problem->other_text);
      text += excerpt(problem->other, 1);
    }
  }
  return text;
}

void Problems::throw_if_any() const {
  if (!empty()) throw Error(ExitCode::usage, render());
}

std::string describe(const Location& where) {
  if (where.line < 1) return where.file.empty() ? "scene" : where.file;
  return fmt::format("{}:{}:{}", where.file, where.line, where.column);
}

std::string alternatives(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += fmt::format("'{}'", words[i]);
  }
  return text;
}

}  // namespace pileus::scene

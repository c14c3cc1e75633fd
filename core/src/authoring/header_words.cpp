#include "authoring/header_words.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <sstream>

namespace pileus::authoring {
namespace {

constexpr std::string_view blank = " \t\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

/// A comment's words on one line, without the stars that its further lines begin with.
std::string comment_text(std::string_view inside) {
  std::istringstream lines{std::string(inside)};
  std::string text, line;
  while (std::getline(lines, line)) {
    std::string_view words = trimmed(line);
    if (words.starts_with('*')) words = trimmed(words.substr(1));
    if (words.empty()) continue;
    text += (text.empty() ? "" : " ") + std::string(words);
  }
  return text;
}

/// Takes a comment off the front of the text, if one stands there.
std::optional<std::string> take_comment(std::string_view& text) {
  const std::string_view ahead =
      text.substr(std::min(text.find_first_not_of(" \t\n,"), text.size()));
  if (!ahead.starts_with("/*")) return std::nullopt;
  const std::size_t end = ahead.find("*/");
  if (end == std::string_view::npos) return std::nullopt;
  text = ahead.substr(end + 2);
  return comment_text(ahead.substr(2, end - 2));
}

/// Takes "NAME" or "NAME = VALUE" off the front; the next value in sequence where none is given.
std::optional<Enumerator> take_enumerator(std::string_view& text, long next) {
  const std::size_t begin = text.find("PILEUS_");
  if (begin == std::string_view::npos) return std::nullopt;
  const std::size_t end = text.find_first_of(",/} \n", begin);
  Enumerator found{std::string(text.substr(begin, end - begin)), next, {}};
  text = end == std::string_view::npos ? std::string_view{} : text.substr(end);
  const std::string_view rest = trimmed(text);
  if (rest.starts_with('=')) {
    const std::string_view number = trimmed(rest.substr(1));
    const auto parsed = std::from_chars(number.data(), number.data() + number.size(), found.value);
    text = number.substr(static_cast<std::size_t>(parsed.ptr - number.data()));
    if (text.starts_with('u')) text.remove_prefix(1);
  }
  found.comment = take_comment(text).value_or("");
  return found;
}

/// "status" where a type pileus_status stands just before; else what all words begin with, as "log"
/// of PILEUS_LOG_DEBUG, PILEUS_LOG_INFO …; empty where that is nothing.
std::string title_by_words(std::string_view before, const std::vector<Enumerator>& enumerators) {
  constexpr std::string_view type = "typedef uint32_t pileus_", prefix = "PILEUS_";
  std::string_view last = trimmed(before);
  last = last.substr(last.rfind('\n') + 1);
  if (last.starts_with(type))
    return std::string(last.substr(type.size(), last.find(';') - type.size()));
  std::string shared = enumerators.empty() ? "" : enumerators.front().name;
  for (const Enumerator& e : enumerators) {
    const auto differs = std::mismatch(shared.begin(), shared.end(), e.name.begin(), e.name.end());
    shared.erase(differs.first, shared.end());
  }
  shared.resize(std::max(prefix.size(), shared.rfind('_') + 1) - 1);
  std::string title = shared.size() > prefix.size() ? shared.substr(prefix.size()) : "";
  for (char& c : title) c = static_cast<char>(std::tolower(c));
  return title;
}

Enumeration read_enumeration(std::string_view before, std::string_view body,
                             std::string_view after) {
  Enumeration result;
  result.title = take_comment(body).value_or("");
  while (const auto next = take_enumerator(
             body, result.enumerators.empty() ? 0 : result.enumerators.back().value + 1)) {
    result.enumerators.push_back(*next);
  }
  std::string_view rest = after.substr(0, after.find('\n'));
  if (result.title.empty()) result.title = take_comment(rest).value_or("");
  if (result.title.empty()) result.title = title_by_words(before, result.enumerators);
  return result;
}

}  // namespace

std::vector<Enumeration> enumerations(std::string_view header) {
  constexpr std::string_view opening = "enum {", closing = "};";
  std::vector<Enumeration> found;
  for (std::size_t at = header.find(opening); at != std::string_view::npos;
       at = header.find(opening, at)) {
    const std::size_t begin = at + opening.size(), end = header.find(closing, begin);
    if (end == std::string_view::npos) break;
    Enumeration one = read_enumeration(header.substr(0, at), header.substr(begin, end - begin),
                                       header.substr(end + closing.size()));
    at = end;
    if (!one.title.empty()) found.push_back(std::move(one));
  }
  return found;
}

std::vector<DocumentedFunction> documented_functions(std::string_view header,
                                                     const std::vector<std::string>& types) {
  std::istringstream lines{std::string(header)};
  std::vector<DocumentedFunction> found;
  std::string line, comment;
  while (std::getline(lines, line)) {
    std::string_view words = trimmed(line);
    if (words.starts_with("///")) {
      comment += (comment.empty() ? "" : " ") + std::string(trimmed(words.substr(3)));
      continue;
    }
    const auto returns = [&](const std::string& type) { return words.starts_with(type + " "); };
    const auto type = std::find_if(types.begin(), types.end(), returns);
    if (type != types.end() && !comment.empty()) {
      std::string declaration(words.substr(type->size() + 1));
      while (declaration.find(')') == std::string::npos && std::getline(lines, line)) {
        declaration += " " + std::string(trimmed(line));
      }
      declaration.resize(declaration.find(')') + 1);
      found.push_back({declaration, comment});
    }
    comment.clear();
  }
  return found;
}

}  // namespace pileus::authoring

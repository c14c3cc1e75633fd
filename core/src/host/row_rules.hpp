// What a well-formed text and row is; shared by the checks of the operator tables.
#pragma once
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "host/first_size.hpp"

namespace pileus::host {

/// Longest text and longest list a plugin may declare: beyond it, memory was misread.
inline constexpr std::size_t longest_text = 4096;
inline constexpr std::size_t longest_list = 1024;
inline constexpr std::size_t largest_row = 65536;

/// Collects complaints about one operator, each beginning with the place.
class Complaints {
 public:
  explicit Complaints(std::vector<std::string>& list) : list_(list) {}
  void add(const std::string& place, const std::string& text) {
    list_.push_back(place + " " + text);
  }
  void require(bool holds, const std::string& place, const std::string& text) {
    if (!holds) add(place, text);
  }
  /// Requires a non-empty UTF-8 text; returns it, or an empty one.
  std::string_view text(const char* value, const std::string& place);
  /// The same of a text that may be left out.
  void optional_text(const char* value, const std::string& place) {
    if (value != nullptr && *value != '\0') text(value, place);
  }
  /// A later version may give the member a meaning, and zero is the one that it has had always.
  void reserved(std::uint32_t value, const std::string& place) {
    require(value == 0, place, "has a reserved member that is not 0");
  }

 private:
  std::vector<std::string>& list_;
};

/// Lower-case words joined by underscores, beginning with a letter.
bool is_identifier(std::string_view text);
/// At least two identifiers joined by dots.
bool is_reverse_dns(std::string_view text);
/// Three numbers joined by dots, optionally followed by -… or +….
bool is_semantic_version(std::string_view text);
bool is_utf8(std::string_view text);

/// A copy of a row of an older or newer plugin at today's length: what it lacks is zero.
template <class T>
T widened(const T& row) {
  T copy{};
  std::memcpy(&copy, &row, row.size < sizeof(T) ? row.size : sizeof(T));
  return copy;
}

/// Copies a zero-terminated list of rows, complaining about lists without end and rows of
/// impossible size.
template <class T>
std::vector<T> copy_rows(const T* const* list, const std::string& place, Complaints& complaints) {
  std::vector<T> rows;
  for (; list != nullptr && *list != nullptr; ++list) {
    if (rows.size() == longest_list) {
      complaints.add(place, "has no end: its list must close with a null pointer");
      return rows;
    }
    if ((*list)->size < first_size<T> || (*list)->size > largest_row) {
      complaints.add(place + " " + std::to_string(rows.size()),
                     "has size " + std::to_string((*list)->size) + " where at least " +
                         std::to_string(first_size<T>) + " is needed: set it to sizeof the row");
      return rows;
    }
    rows.push_back(widened(**list));
  }
  return rows;
}

}  // namespace pileus::host

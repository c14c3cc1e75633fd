// Text as a word of a shell command, for commands that are written out to be pasted or run.
#pragma once
#include <algorithm>
#include <string>
#include <string_view>

namespace pileus {

/// The text itself if a shell takes it as one word, else in single quotes.
inline std::string shell_word(const std::string& text) {
  constexpr std::string_view harmless = "_-./+:@%,=";
  const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           harmless.find(c) != std::string_view::npos;
  });
  if (plain) return text;
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

}  // namespace pileus

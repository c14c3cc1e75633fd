// What is wrong with a scene: collected while reading, reported all at once.
#pragma once
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"

namespace pileus::scene {

/// One mistake and where it stands.
struct Problem {
  Location where;
  std::string text;        // what was found, what is allowed; no trailing full stop needed
  int width = 1;           // characters the carets underline
  Location other;          // a second place that belongs to it (file empty: none) …
  std::string other_text;  // … and what is there
};

/// All problems of one scene, with the text of the files they point into.
class Problems {
 public:
  void add(const Location& where, std::string text, int width = 1);
  void add(Problem problem) { problems_.push_back(std::move(problem)); }

  /// Remembers a file's text, so that its lines can be shown.
  void remember_source(const std::string& file, std::string_view text);

  bool empty() const { return problems_.empty(); }
  std::size_t size() const { return problems_.size(); }
  const std::vector<Problem>& list() const { return problems_; }

  /// All problems in the order of files, lines and columns; each as
  /// `file:line:column: error: text`, the line, and carets under the place.
  std::string render() const;

  /// Throws pileus::Error with ExitCode::usage and the rendered text unless empty.
  void throw_if_any() const;

 private:
  std::string excerpt(const Location& where, int width) const;

  std::vector<Problem> problems_;
  std::map<std::string, std::vector<std::string>> sources_;
  std::vector<std::string> order_;  // of the files, as remembered
};

/// "file:line:column", or the file alone where there is no line (command line).
std::string describe(const Location& where);

/// "one, two or three"; each in quotes.
std::string alternatives(const std::vector<std::string>& words);

}  // namespace pileus::scene

// A mistake of a scene that shows only after it is read, with its place there.
#pragma once
#include <string>
#include <utility>

#include "base/error.hpp"
#include "scene/problems.hpp"

namespace pileus::scene {

/// An error that says where; whoever collects problems takes place and text apart.
class PlacedError : public Error {
 public:
  PlacedError(const Location& where, std::string text)
      : Error(ExitCode::usage, describe(where) + ": error: " + text),
        where_(where),
        text_(std::move(text)) {}

  const Location& where() const { return where_; }
  const std::string& text() const { return text_; }

 private:
  Location where_;
  std::string text_;
};

}  // namespace pileus::scene

// The record of a call in memory that is watched: where nothing may be written, writing is caught.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conform/frame.hpp"

namespace pileus::conform {

/// A piece of memory between two pages that cannot be written.
class GuardedMemory {
 public:
  GuardedMemory(const void* from, std::size_t bytes, std::string name);
  ~GuardedMemory();
  GuardedMemory(const GuardedMemory&) = delete;
  GuardedMemory& operator=(const GuardedMemory&) = delete;

  void* data() const { return data_; }
  std::size_t bytes() const { return bytes_; }
  const std::string& name() const { return name_; }
  void protect();
  /// Whether the few bytes before the data, on the same page, are as they were.
  bool margin_is_untouched() const;
  bool holds(const void* address) const;
  bool is_inside(const void* address) const;

 private:
  std::string name_;
  unsigned char* pages_ = nullptr;
  std::size_t length_ = 0;  // of all pages
  unsigned char* data_ = nullptr;
  std::size_t bytes_;
};

/// Runs a call on guarded copies of everything the record refers to and copies the results back. A
/// sentence on the first forbidden write, nothing if there was none.
///
/// `call` is left as the plugin saw it, its memory gone.
std::optional<std::string> call_guarded(Frame& frame, Call& call, bool diagnosing,
                                        const std::function<void()>& hook);

}  // namespace pileus::conform

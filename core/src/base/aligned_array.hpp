// Heap arrays for vector loops: 64-byte aligned, padded, never initialised behind one's back.
#pragma once
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace pileus {

/// One cache line; also the width of the widest vector register in use.
inline constexpr std::size_t cache_line_bytes = 64;

/// An owning array of trivially copyable `T`, 64-byte aligned, its allocation a whole number of
/// cache lines. Contents are undefined after construction and `discard_and_resize`.
template <class T>
class AlignedArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size) { discard_and_resize(size); }

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  std::size_t size() const { return size_; }

  /// Sets the size; old contents are lost when the array has to grow.
  void discard_and_resize(std::size_t size) {
    if (padded(size) > capacity_) {
      data_.reset(allocate(padded(size)));
      capacity_ = padded(size);
    }
    size_ = size;
  }

  /// Sets the size and keeps the common prefix.
  void resize(std::size_t size) {
    if (padded(size) > capacity_) {
      const std::size_t room = padded(size);
      std::unique_ptr<T[], Free> grown(allocate(room));
      if (size_ > 0) std::memcpy(grown.get(), data_.get(), size_ * sizeof(T));
      data_ = std::move(grown);
      capacity_ = room;
    }
    size_ = size;
  }

  void fill(const T& value) {
    for (std::size_t i = 0; i < size_; ++i) data_[i] = value;
  }

  std::size_t allocated_bytes() const { return capacity_ * sizeof(T); }
  void swap(AlignedArray& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  static std::size_t padded(std::size_t count) {
    constexpr std::size_t per_line =
        cache_line_bytes / sizeof(T) > 0 ? cache_line_bytes / sizeof(T) : 1;
    return (count + per_line - 1) / per_line * per_line;
  }
  static T* allocate(std::size_t count) {
    const std::size_t bytes =
        (count * sizeof(T) + cache_line_bytes - 1) / cache_line_bytes * cache_line_bytes;
    if (bytes == 0) return nullptr;
    void* p = std::aligned_alloc(cache_line_bytes, bytes);
    if (p == nullptr) throw std::bad_alloc();
    return static_cast<T*>(p);
  }

  std::unique_ptr<T[], Free> data_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace pileus

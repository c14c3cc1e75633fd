// One block of working memory per thread, allocated before the first parallel region needs it.
#pragma once
#include <omp.h>

#include <vector>

#include "base/aligned_array.hpp"

namespace pileus::mesh {

class ThreadScratch {
 public:
  ThreadScratch() = default;
  explicit ThreadScratch(std::size_t doubles) : doubles_(doubles) { reserve(); }

  /// To be called outside parallel regions; allocates only if the number of threads has grown.
  void reserve() {
    while (blocks_.size() < std::size_t(omp_get_max_threads())) {
      blocks_.emplace_back(doubles_);
      blocks_.back().fill(0);
    }
  }
  /// The calling thread's block, 64-byte aligned.
  double* mine() { return blocks_[std::size_t(omp_get_thread_num())].data(); }
  std::size_t allocated_bytes() const { return blocks_.size() * doubles_ * sizeof(double); }

 private:
  std::size_t doubles_ = 0;
  std::vector<AlignedArray<double>> blocks_;
};

/// Doubles rounded up to whole cache lines, so that blocks carved from a scratch stay aligned.
inline std::size_t aligned_doubles(std::size_t doubles) {
  return (doubles + 7) / 8 * 8;
}

}  // namespace pileus::mesh

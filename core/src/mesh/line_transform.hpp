// Discrete Fourier transforms of many lines at once; the only user of FFTW.
#pragma once
#include <memory>

namespace pileus::mesh {

/// Complex transforms of length `length`, `batch` of them side by side: element i of line b is the
/// complex number at [i*batch + b], stored as two adjacent doubles.
///
/// Two real lines travel as one complex line: every operation between a forward and a backward
/// transform that multiplies mode κ by m(κ) with m(−κ) = conj m(κ) acts on both at once. Real
/// columns of the mesh pair level 2p (real part) with level 2p + 1 (imaginary part).
///
/// Plans come from FFTW's estimate mode, so that a plan, and with it every bit of the result,
/// depends on the lengths alone. Planning takes a lock; executing is thread-safe.
class LineTransform {
 public:
  LineTransform(int length, int batch);
  ~LineTransform();
  LineTransform(LineTransform&&) noexcept;
  LineTransform& operator=(LineTransform&&) noexcept;

  int length() const { return length_; }
  int batch() const { return batch_; }
  /// Doubles one set of lines occupies.
  std::size_t doubles() const { return 2 * std::size_t(length_) * std::size_t(batch_); }

  /// Σ_i in_i exp(−2πi κ i/n), unscaled. `in` and `out` must not overlap and must be 16-byte
  /// aligned; `in` is kept.
  void forward(const double* in, double* out) const;
  /// Σ_κ in_κ exp(+2πi κ i/n), unscaled: backward(forward(x)) = n x.
  void backward(const double* in, double* out) const;

 private:
  struct Plans;
  int length_ = 0;
  int batch_ = 0;
  std::unique_ptr<Plans> plans_;
};

/// Signed wavenumber index of storage index m of n: 0 … ⌈n/2⌉−1, then negative.
inline int signed_index(int m, int n) {
  return 2 * m > n ? m - n : m;
}
/// True at the wavenumber whose sine vanishes at every node, so that it has no derivative there.
inline bool is_nyquist(int m, int n) {
  return 2 * m == n;
}
/// Wavenumber for differentiation (rad/m): 2π m/extent, zero at the Nyquist index.
double derivative_wavenumber(int m, int n, double extent);

}  // namespace pileus::mesh

// Fourier transforms of lines.
#include "mesh/line_transform.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "base/aligned_array.hpp"
#include "base/error.hpp"
#include "mesh/mode_columns.hpp"

namespace pileus::mesh {
namespace {

using Complex = std::complex<double>;

TEST(LineTransform, EqualsTheDefiningSum) {
  for (const int n : {1, 2, 5, 7, 12, 13, 48})
    for (const int batch : {1, 3, 8}) {
      const LineTransform lines(n, batch);
      AlignedArray<double> in(lines.doubles()), out(lines.doubles()), back(lines.doubles());
      std::mt19937_64 engine(std::uint64_t{7} + std::uint64_t(n));
      std::uniform_real_distribution<double> uniform(-1, 1);
      for (std::size_t i = 0; i < in.size(); ++i) in[i] = uniform(engine);
      lines.forward(in.data(), out.data());
      lines.backward(out.data(), back.data());
      const auto at = [&](const AlignedArray<double>& a, int i, int b) {
        const auto index = 2 * std::size_t(i * batch + b);
        return Complex(a[index], a[index + 1]);
      };
      for (int b = 0; b < batch; ++b)
        for (int m = 0; m < n; ++m) {
          Complex sum = 0;
          for (int i = 0; i < n; ++i)
            sum += at(in, i, b) * std::polar(1.0, -2 * std::numbers::pi * double(m * i % n) / n);
          EXPECT_LT(std::abs(at(out, m, b) - sum), 1e-15 * n * 4);
          EXPECT_LT(std::abs(at(back, m, b) - double(n) * at(in, m, b)), 1e-15 * n * 4);
        }
    }
}

TEST(LineTransform, RefusesNothingToTransform) {
  EXPECT_THROW(LineTransform(0, 4), Error);
  EXPECT_THROW(LineTransform(4, 0), Error);
}

TEST(ModeColumns, PackedPairsHoldTheAmplitudesOfRealLevels) {
  // Transform six real levels two by two and one by one; the former unpack to the latter, and
  // packing inverts unpacking.
  const int n = 7, levels = 6;
  const LineTransform packed(n, levels / 2), plain(n, levels);
  AlignedArray<double> in(packed.doubles()), spectrum(packed.doubles());
  AlignedArray<double> real_in(plain.doubles()), reference(plain.doubles());
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (std::size_t i = 0; i < in.size(); ++i) {
    in[i] = uniform(engine);
    real_in[2 * i] = in[i];
    real_in[2 * i + 1] = 0;
  }
  packed.forward(in.data(), spectrum.data());
  plain.forward(real_in.data(), reference.data());
  for (int m = 1; m < n; ++m) {
    double real[levels], imaginary[levels], a[levels], b[levels];
    unpack_mode(spectrum.data() + m * levels, spectrum.data() + (n - m) * levels, levels, 1, real,
                imaginary);
    pack_mode(real, imaginary, levels, a, b);
    for (int k = 0; k < levels; ++k) {
      EXPECT_NEAR(real[k], reference[std::size_t(2 * (m * levels + k))], 1e-14);
      EXPECT_NEAR(imaginary[k], reference[std::size_t(2 * (m * levels + k) + 1)], 1e-14);
      EXPECT_NEAR(a[k], spectrum[std::size_t(m * levels + k)], 1e-14);
      EXPECT_NEAR(b[k], spectrum[std::size_t((n - m) * levels + k)], 1e-14);
    }
  }
}

TEST(Wavenumbers, AreSignedAndHaveNoDerivativeAtNyquist) {
  EXPECT_EQ(derivative_wavenumber(4, 8, 1), 0);
  EXPECT_DOUBLE_EQ(derivative_wavenumber(3, 8, 2), 3 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(derivative_wavenumber(5, 8, 2), -3 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(derivative_wavenumber(3, 7, 2), 3 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(derivative_wavenumber(4, 7, 2), -3 * std::numbers::pi);
}

}  // namespace
}  // namespace pileus::mesh

// A size distribution cut into strata, one for each superdroplet.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "size_distribution.hpp"

namespace pileus::superdroplets {

/// How the range of sizes is cut.
enum class Sampling {
  constant_multiplicity,  // strata of equal number (Shima et al. 2009, doi:10.1002/qj.441)
  log_uniform,            // of equal width in ln r
  alpha                   // between (Matsushima et al. 2023, doi:10.5194/gmd-16-6211-2023)
};

struct SamplingOptions {
  Sampling method = Sampling::alpha;
  double alpha = 0.7;        // 0: strata of equal number, 1: of equal width
  double truncation = 1e-8;  // share of the number beyond either end of the range
  double exponent() const {
    if (method == Sampling::constant_multiplicity) return 0.0;
    return method == Sampling::log_uniform ? 1.0 : std::clamp(alpha, 0.0, 1.0);
  }
};

/// n strata whose density over x = ln r is that of the number to the power 1 − α. The outermost
/// two stand for all that lies beyond them too, so that the shares of the number add up to 1.
class Strata {
 public:
  Strata(const SizeDistribution& distribution, std::size_t count, const SamplingOptions& options)
      : distribution_(distribution), count_(count), exponent_(options.exponent()) {
    low_ = distribution.uniform_size() ? distribution.centre()
                                       : distribution.quantile(options.truncation);
    high_ = distribution.uniform_size() ? distribution.centre()
                                        : distribution.upper_quantile(options.truncation);
    if (exponent_ > 0 && exponent_ < 1 && low_ < high_) tabulate();
    below_.resize(count + 1);
    above_.resize(count + 1);
    for (std::size_t j = 0; j <= count; ++j) cut(j);
  }

  std::size_t count() const { return count_; }
  /// Share of the number in all strata before the j-th; 0 for the first, 1 past the last.
  double share_below(std::size_t j) const { return below_[j]; }

  /// The size that stands for stratum j, drawn by a uniform u of (0, 1) from the particles in it:
  /// means over many draws are those of the distribution.
  double radius(std::size_t j, double u) const {
    if (distribution_.uniform_size()) return std::exp(distribution_.centre());
    const bool lower = below_[j + 1] < 0.5;
    const std::vector<double>& share = lower ? below_ : above_;
    const double p = share[j] + u * (share[j + 1] - share[j]);
    return std::exp(lower ? distribution_.quantile(p) : distribution_.upper_quantile(p));
  }

 private:
  static constexpr std::size_t cells = 4096;

  void cut(std::size_t j) {
    const double fraction = static_cast<double>(j) / static_cast<double>(count_);
    below_[j] = fraction;
    above_[j] = 1.0 - fraction;
    if (j == 0 || j == count_ || exponent_ == 0 || !(low_ < high_)) return;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double x = position(fraction);
    below_[j] = distribution_.between(-infinity, x);
    above_[j] = distribution_.between(x, infinity);
  }

  /// x below which a fraction of the superdroplets lies.
  double position(double fraction) const {
    if (exponent_ == 1) return low_ + fraction * (high_ - low_);
    const double target = fraction * cumulative_.back();
    const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end(), target);
    const auto k =
        static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - cumulative_.begin(), 1, cells));
    const double part = (target - cumulative_[k - 1]) / (cumulative_[k] - cumulative_[k - 1]);
    return low_ + (static_cast<double>(k - 1) + part) / cells * (high_ - low_);
  }

  void tabulate() {
    cumulative_.assign(cells + 1, 0.0);
    for (std::size_t k = 0; k < cells; ++k) {
      const double x = low_ + (static_cast<double>(k) + 0.5) / cells * (high_ - low_);
      cumulative_[k + 1] = cumulative_[k] + std::pow(distribution_.density(x), 1.0 - exponent_);
    }
  }

  SizeDistribution distribution_;
  std::size_t count_;
  double exponent_, low_, high_;
  std::vector<double> cumulative_;     // of the superdroplets, over equal cells of x
  std::vector<double> below_, above_;  // shares of the number on either side of each edge
};

}  // namespace pileus::superdroplets

#include "study/sweep_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pileus::study {

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Of sorted values.
double percentile(std::span<const double> sorted, double percent) {
  const double place = percent / 100 * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double share = place - static_cast<double>(below);
  return sorted[below] + share * (sorted[above] - sorted[below]);
}

}  // namespace

MemberStatistics statistics_of(std::vector<double>& values) {
  MemberStatistics result{missing, missing, {}};
  result.at_percentile.fill(missing);
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return result;
  const auto count = static_cast<double>(values.size());
  double sum = 0, squares = 0;
  for (const double value : values) sum += value;
  result.mean = sum / count;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.deviation = std::sqrt(squares / count);
  std::sort(values.begin(), values.end());
  for (std::size_t p = 0; p < percentiles.size(); ++p)
    result.at_percentile[p] = percentile(values, percentiles[p]);
  return result;
}

std::vector<double> interpolate_rows(std::span<const double> nodes, std::span<const double> values,
                                     std::size_t width, std::span<const double> places) {
  std::vector<double> result(places.size() * width, missing);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto above = std::lower_bound(nodes.begin(), nodes.end(), places[i]);
    if (above == nodes.end()) continue;
    const auto j = static_cast<std::size_t>(above - nodes.begin());
    if (*above != places[i] && j == 0) continue;
    const double share =
        *above == places[i] ? 1 : (places[i] - nodes[j - 1]) / (nodes[j] - nodes[j - 1]);
    for (std::size_t w = 0; w < width; ++w) {
      const double upper = values[j * width + w];
      result[i * width + w] =
          share == 1 ? upper : (1 - share) * values[(j - 1) * width + w] + share * upper;
    }
  }
  return result;
}

std::vector<double> common_times(const std::vector<std::vector<double>>& times, double every) {
  std::vector<double> common;
  double latest = -std::numeric_limits<double>::infinity();
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  bool agree = true;
  for (const std::vector<double>& member : times) {
    if (member.empty()) continue;
    agree = agree && member == times.front();
    latest = std::max(latest, member.back());
    fewest = std::min(fewest, member.size());
  }
  if (!std::isfinite(latest)) return common;
  if (agree) return times.front();
  if (every <= 0 && fewest > 1) every = latest / static_cast<double>(fewest - 1);
  // A last interval that is all rounding is none.
  for (std::size_t n = 0; every > 0 && static_cast<double>(n) * every < latest - 1e-6 * every; ++n)
    common.push_back(static_cast<double>(n) * every);
  common.push_back(latest);
  return common;
}

}  // namespace pileus::study

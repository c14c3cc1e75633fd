#include "model/slab_sums.hpp"

#include <algorithm>
#include <limits>

#include "base/parallel.hpp"

namespace pileus::model {
namespace {

/// Parcels are cut into so many parts at most, however many there are: each has its own sums.
constexpr std::size_t most_parts = 64;
constexpr std::size_t shortest_part = 8192;

std::size_t part_length(std::size_t parcels) {
  const std::size_t needed = (parcels + most_parts - 1) / most_parts;
  return std::max(shortest_part, (needed + 7) / 8 * 8);
}

/// Without overlap, which lets several sums be formed at once.
void add_terms(const double* __restrict terms, std::size_t count, double below, double above,
               double* __restrict low, double* __restrict high) {
  for (std::size_t i = 0; i < count; ++i) {
    low[i] += below * terms[i];
    high[i] += above * terms[i];
  }
}

/// The levels around a parcel and its weights there.
struct Place {
  std::size_t level;
  double below, above;
};

Place place_of(const SlabState& state, std::size_t levels, std::size_t p) {
  const double xi = (state.height[p] - state.bottom) / state.spacing;
  const auto last = static_cast<double>(levels - 2);
  const double level = xi > 0 ? std::min(static_cast<double>(static_cast<long>(xi)), last) : 0.0;
  const double above = std::clamp(xi - level, 0.0, 1.0);
  return {static_cast<std::size_t>(level), 1 - above, above};
}

}  // namespace

SlabSums::SlabSums(SlabLayout layout, std::size_t levels)
    : layout_(std::move(layout)),
      levels_(levels),
      volume_(levels),
      means_(levels * layout_.variables),
      values_(levels * layout_.moments()) {}

/// add(begin, end, rows) adds parcels to rows[level][column].
template <class Add>
void SlabSums::sum_over_parcels(std::size_t parcels, std::size_t columns, Add&& add) {
  const std::size_t length = part_length(parcels), size = levels_ * columns;
  const std::size_t parts = std::max<std::size_t>(1, (parcels + length - 1) / length);
  partials_.assign(parts * size, 0.0);
  parallel_chunks(
      parcels,
      [&](std::size_t begin, std::size_t end) {
        add(begin, end, partials_.data() + begin / length * size);
      },
      length);
  for (std::size_t part = 1; part < parts; ++part)
    for (std::size_t i = 0; i < size; ++i) partials_[i] += partials_[part * size + i];
}

void SlabSums::measure(const SlabState& state) {
  sum_over_parcels(state.parcels, 1 + layout_.variables,
                   [&](std::size_t begin, std::size_t end, double* rows) {
                     add_first(state, begin, end, rows);
                   });
  settle_means();
  // In the second pass the places of the means hold the mean deviations from the first.
  sum_over_parcels(state.parcels, layout_.moments(),
                   [&](std::size_t begin, std::size_t end, double* rows) {
                     add_second(state, begin, end, rows);
                   });
  settle_moments();
}

void SlabSums::add_first(const SlabState& state, std::size_t begin, std::size_t end,
                         double* rows) const {
  const std::size_t n = layout_.variables, columns = n + 1;
  for (std::size_t p = begin; p < end; ++p) {
    const Place place = place_of(state, levels_, p);
    const double below = place.below * state.volume[p], above = place.above * state.volume[p];
    double *low = rows + place.level * columns, *high = low + columns;
    low[0] += below;
    high[0] += above;
    for (std::size_t v = 0; v < n; ++v) {
      const double value = state.variables[v][p];
      low[1 + v] += below * value;
      high[1 + v] += above * value;
    }
  }
}

void SlabSums::settle_means() {
  const std::size_t n = layout_.variables;
  for (std::size_t k = 0; k < levels_; ++k) {
    const double* row = partials_.data() + k * (n + 1);
    volume_[k] = row[0];
    // A level without air lends its zeros to nobody: no parcel is near it.
    const double inverse = row[0] > 0 ? 1 / row[0] : 0.0;
    for (std::size_t v = 0; v < n; ++v) means_[k * n + v] = row[1 + v] * inverse;
  }
}

void SlabSums::add_second(const SlabState& state, std::size_t begin, std::size_t end,
                          double* rows) const {
  const std::size_t n = layout_.variables, columns = layout_.moments();
  std::vector<double> terms(columns);
  for (std::size_t p = begin; p < end; ++p) {
    const Place place = place_of(state, levels_, p);
    const double below = place.below * state.volume[p], above = place.above * state.volume[p];
    const double *mean_low = means_.data() + place.level * n, *mean_high = mean_low + n;
    const auto deviation = [&](std::size_t v) {
      return state.variables[v][p] - (place.below * mean_low[v] + place.above * mean_high[v]);
    };
    const double w = deviation(layout_.vertical);
    // In the order of the layout: means, variances, fluxes, the third moment.
    double *deviations = terms.data(), *squares = deviations + n, *products = squares + n;
    for (std::size_t v = 0; v < n; ++v) deviations[v] = deviation(v);
    for (std::size_t v = 0; v < n; ++v) {
      squares[v] = deviations[v] * deviations[v];
      products[v] = w * deviations[v];
    }
    products[n] = w * w * w;
    double* low = rows + place.level * columns;
    const auto add = [&](std::size_t first, std::size_t last) {
      add_terms(terms.data() + first, last - first, below, above, low + first,
                low + columns + first);
    };
    add(0, layout_.third() + 1);
    if (!layout_.has_sets || !(state.liquid[p] > state.cloud_threshold)) continue;
    const double excess = terms[layout_.mean(layout_.buoyancy)];
    for (const SlabLayout::Set set : {SlabLayout::cloud, SlabLayout::core}) {
      if (set == SlabLayout::core && !(excess > 0)) continue;
      terms[layout_.fraction(set)] = 1;
      terms[layout_.mass_flux(set)] = w;
      terms[layout_.excess(set)] = excess;
      for (std::size_t i = 0; i < layout_.of_sets.size(); ++i)
        terms[layout_.sum(set, i)] = state.variables[layout_.of_sets[i]][p];
      add(layout_.fraction(set), layout_.fraction(set) + layout_.set_moments());
    }
  }
}

/// Divides by the volume, takes the mean deviations out of the moments and puts the means in their
/// places.
void SlabSums::settle_moments() {
  const std::size_t n = layout_.variables, columns = layout_.moments();
  for (std::size_t k = 0; k < levels_; ++k) {
    double* row = partials_.data() + k * columns;
    const double inverse =
        volume_[k] > 0 ? 1 / volume_[k] : std::numeric_limits<double>::quiet_NaN();
    for (std::size_t m = 0; m < columns; ++m) row[m] *= inverse;
    const double w = row[layout_.mean(layout_.vertical)];
    const double w2 = row[layout_.variance(layout_.vertical)];
    row[layout_.third()] += w * (2 * w * w - 3 * w2);
    for (std::size_t v = 0; v < n; ++v) {
      const double phi = row[layout_.mean(v)];
      row[layout_.variance(v)] = std::max(0.0, row[layout_.variance(v)] - phi * phi);
      row[layout_.flux(v)] -= w * phi;
    }
    for (std::size_t v = 0; v < n; ++v)
      row[layout_.mean(v)] =
          volume_[k] > 0 ? means_[k * n + v] : std::numeric_limits<double>::quiet_NaN();
    for (std::size_t m = 0; m < columns; ++m) values_[m * levels_ + k] = row[m];
  }
}

}  // namespace pileus::model

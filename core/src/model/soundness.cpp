#include "model/soundness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.hpp"
#include "coupling/quantity_plan.hpp"
#include "parcels/cell_order.hpp"
#include "parcels/kernels.hpp"

namespace pileus::model {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Shapes {
  double longest_ratio2 = 0;  // squared aspect ratio
  double volume_error = 0;
  double smallest = infinity, largest = 0;  // volume
  double indefinite = 0;
  Shapes& operator+=(const Shapes& o) {
    longest_ratio2 = std::max(longest_ratio2, o.longest_ratio2);
    volume_error = std::max(volume_error, o.volume_error);
    smallest = std::min(smallest, o.smallest);
    largest = std::max(largest, o.largest);
    indefinite += o.indefinite;
    return *this;
  }
};

/// Leading principal minors of B, the last of which is its determinant.
std::array<double, 3> minors(const parcels::Store& store, std::size_t p) {
  const auto b = [&](int c) { return store.shape(c)[p]; };
  if (store.dimension() == 2) return {b(0), b(0) * b(2) - b(1) * b(1), 1.0};
  const double second = b(0) * b(3) - b(1) * b(1);
  const double third = b(0) * (b(3) * b(5) - b(4) * b(4)) - b(1) * (b(1) * b(5) - b(4) * b(2)) +
                       b(2) * (b(1) * b(4) - b(3) * b(2));
  return {b(0), second, third};
}

/// The determinant a shape of volume V has: (V/π)² of an ellipse, (3V/4π)² of an ellipsoid.
double determinant_for(double volume, int dimension) {
  constexpr double over_pi = 0.31830988618379067154, three_over_four_pi = 0.23873241463784300365;
  const double product = volume * (dimension == 2 ? over_pi : three_over_four_pi);
  return product * product;
}

Shapes shapes_between(const parcels::Store& store, std::size_t begin, std::size_t end) {
  constexpr std::size_t block = 256;
  double longest[block + 8], ratio[block + 8];
  const double* shape[6];
  const auto measure = store.dimension() == 3 ? parcels::kernels().axis_ratios_3d
                                              : parcels::kernels().axis_ratios_2d;
  Shapes found;
  for (std::size_t first = begin; first < end; first += block) {
    const std::size_t count = std::min(block, end - first);
    for (int c = 0; c < store.shape_components(); ++c) shape[c] = store.shape(c) + first;
    measure(shape, longest, ratio, 0, count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t p = first + i;
      const double volume = store.volume()[p], size = store.size_volume()[p];
      found.smallest = std::min(found.smallest, volume);
      found.largest = std::max(found.largest, volume);
      const std::array<double, 3> minor = minors(store, p);
      if (!(minor[0] > 0 && minor[1] > 0 && minor[2] > 0)) ++found.indefinite;
      found.longest_ratio2 = std::max(found.longest_ratio2, ratio[i]);
      const double determinant = minor[store.dimension() == 2 ? 1 : 2];
      found.volume_error = std::max(
          found.volume_error, std::abs(determinant / determinant_for(size, store.dimension()) - 1));
    }
  }
  return found;
}

struct Moments {
  double low = infinity, high = -infinity, sum = 0;
};

/// Extrema, and the integral over the volume.
Moments moments_of(const parcels::Store& store, int scalar) {
  const double* value = store.scalar(scalar);
  const double* volume = store.volume();
  return ordered_reduce(
      store.size(), Moments{},
      [&](std::size_t begin, std::size_t end) {
        Moments m;
        for (std::size_t p = begin; p < end; ++p) {
          m.low = std::min(m.low, value[p]);
          m.high = std::max(m.high, value[p]);
          m.sum += volume[p] * value[p];
        }
        return m;
      },
      [](const Moments& a, const Moments& b) {
        return Moments{std::min(a.low, b.low), std::max(a.high, b.high), a.sum + b.sum};
      });
}

}  // namespace

Soundness::Soundness(const Simulation& simulation, const std::vector<std::string>& changed) {
  const auto& scalars = simulation.store().scalars();
  for (std::size_t s = 0; s < scalars.size(); ++s)
    if (scalars[s].nature == parcels::Nature::intensive &&
        scalars[s].name != coupling::previous_height_name &&
        std::find(changed.begin(), changed.end(), scalars[s].name) == changed.end())
      carried_.push_back({static_cast<int>(s), 0, 0, 0});
}

std::vector<std::array<std::string, 3>> Soundness::outputs() {
  return {
      {"indefinite_shapes", "1", "parcels whose shape matrix is not positive definite"},
      {"shape_volume_error", "1",
       "largest relative error of a shape's determinant for the volume it stands for"},
      {"max_aspect_ratio", "1", "largest ratio of a parcel's longest half-axis to its shortest"},
      {"min_parcel_volume", "1", "smallest parcel volume over the cell volume"},
      {"max_parcel_volume", "1", "largest parcel volume over the cell volume"},
      {"broken_shapes", "1",
       "shapes that a step stretched beyond measure, and blunted, since the start"},
      {"min_parcels_per_cell", "1", "parcels in the cell with the fewest"},
      {"max_parcels_per_cell", "1", "parcels in the cell with the most"},
      {"empty_cells", "1", "cells without a parcel"},
      {"parcels_outside", "1", "parcels that are not inside the domain"},
      {"carried_range_excess", "1",
       "farthest a quantity that is only carried is outside its initial range, relative to the "
       "range's largest magnitude"},
      {"carried_mean_change", "1",
       "largest change of the mean of a quantity that is only carried, relative to its largest "
       "initial magnitude"}};
}

Soundness::Filling Soundness::count_by_cell(const Simulation& simulation) {
  const pileus_grid grid = simulation.plugin_grid();
  const parcels::Store& store = simulation.store();
  const int dimension = simulation.dimension();
  const auto nx = int(grid.cells[0]), ny = int(grid.cells[1]), nz = int(grid.cells[2]);
  count_.assign(std::size_t(nx) * std::size_t(ny) * std::size_t(nz), 0);
  const auto cell = [&](int axis, int direction, std::size_t p) {
    const auto index = axis == 2 ? parcels::vertical_cell : parcels::periodic_cell;
    return index(store.position(direction)[p], grid.origin[axis], 1 / grid.spacing[axis],
                 int(grid.cells[axis]));
  };
  Filling filling;
  for (std::size_t p = 0; p < store.size(); ++p) {
    bool inside = true;
    for (int d = 0; d < dimension; ++d) {
      const int axis = d == dimension - 1 ? 2 : d;
      const double offset = store.position(d)[p] - grid.origin[axis];
      // Rounded as the domain's own upper end is.
      inside = inside && offset >= 0 &&
               offset <= grid.spacing[axis] * double(grid.cells[axis]) * (1 + 1e-15);
    }
    if (!inside) ++filling.outside;
    const int i = cell(0, 0, p), j = dimension == 3 ? cell(1, 1, p) : 0;
    const int k = cell(2, dimension - 1, p);
    ++count_[(std::size_t(k) * std::size_t(ny) + std::size_t(j)) * std::size_t(nx) +
             std::size_t(i)];
  }
  const auto [fewest, most] = std::minmax_element(count_.begin(), count_.end());
  filling.fewest = *fewest;
  filling.most = *most;
  filling.empty = static_cast<double>(std::count(count_.begin(), count_.end(), 0u));
  return filling;
}

Soundness::Excess Soundness::excess_of_carried(const Simulation& simulation) {
  Excess excess;
  const double inverse = 1 / simulation.domain_volume();
  for (Carried& c : carried_) {
    const Moments now = moments_of(simulation.store(), c.scalar);
    if (!has_first_) c = {c.scalar, now.low, now.high, now.sum * inverse};
    const double magnitude = std::max(std::abs(c.low), std::abs(c.high));
    const double beyond = std::max({now.high - c.high, c.low - now.low, 0.0});
    const double change = std::abs(now.sum * inverse - c.mean);
    // Of a quantity that is zero everywhere, any other value is an error without measure.
    excess.range = std::max(excess.range, beyond == 0 ? 0.0 : beyond / magnitude);
    excess.mean = std::max(excess.mean, change == 0 ? 0.0 : change / magnitude);
  }
  has_first_ = true;
  return excess;
}

std::vector<double> Soundness::measure(const Simulation& simulation) {
  const parcels::Store& store = simulation.store();
  const Shapes shapes = ordered_reduce(
      store.size(), Shapes{},
      [&](std::size_t begin, std::size_t end) { return shapes_between(store, begin, end); },
      [](Shapes a, const Shapes& b) { return a += b; });
  const Filling filling = count_by_cell(simulation);
  const Excess excess = excess_of_carried(simulation);
  const double cell = simulation.cell_volume();
  return {shapes.indefinite,
          shapes.volume_error,
          std::sqrt(shapes.longest_ratio2),
          shapes.smallest / cell,
          shapes.largest / cell,
          static_cast<double>(simulation.broken_shapes()),
          filling.fewest,
          filling.most,
          filling.empty,
          filling.outside,
          excess.range,
          excess.mean};
}

void Soundness::save(output::NamedData& data) const {
  std::vector<double>& first = data.arrays["soundness"];
  first.clear();
  if (!has_first_) return;
  for (const Carried& c : carried_) first.insert(first.end(), {c.low, c.high, c.mean});
}

void Soundness::restore(const output::NamedData& data) {
  const auto found = data.arrays.find("soundness");
  if (found == data.arrays.end() || found->second.size() != 3 * carried_.size()) return;
  for (std::size_t i = 0; i < carried_.size(); ++i) {
    carried_[i].low = found->second[3 * i];
    carried_[i].high = found->second[3 * i + 1];
    carried_[i].mean = found->second[3 * i + 2];
  }
  has_first_ = true;
}

}  // namespace pileus::model

#include "model/size_spectra.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"

namespace pileus::model {
namespace {

constexpr double water_density = 1000.0;  // kg m-3

double mass_of_radius(double r) {
  return water_density * 4.0 / 3.0 * std::numbers::pi * r * r * r;
}

int mass_column(const parcels::ItemLists& items) {
  const auto& columns = items.declaration().columns;
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [](const parcels::ItemColumn& c) { return c.units == "kg"; });
  return found == columns.end() ? -1 : static_cast<int>(found - columns.begin());
}

/// Middles of the cells along one axis of the mesh.
output::Axis cell_axis(const pileus_grid& grid, int axis, const char* name) {
  output::Axis made{{name, "m", fmt::format("{} coordinate of the middle of the cell", name[0])},
                    {},
                    axis == 2 ? "up" : ""};
  for (std::int64_t i = 0; i < grid.cells[axis]; ++i)
    made.values.push_back(grid.origin[axis] + (static_cast<double>(i) + 0.5) * grid.spacing[axis]);
  return made;
}

}  // namespace

SizeSpectra::SizeSpectra(const scene::SpectraControl& control, const Simulation& simulation)
    : control_(control),
      mass_(mass_column(simulation.store().items())),
      grid_(simulation.plugin_grid()),
      domain_volume_(simulation.domain_volume()),
      width_(std::log(control.largest / control.smallest) / control.bins) {
  if (mass_ < 0)
    throw Error(ExitCode::usage,
                "output.spectra: no operator of this run makes droplets whose sizes are known.");
  if (!(control.largest > control.smallest))
    throw Error(ExitCode::usage, "output.spectra: 'largest' is not above 'smallest'.");
  output::Axis radius{{"radius", "m", "middle of the bin, geometric"}, {}};
  for (int b = 0; b < control.bins; ++b) {
    radius.values.push_back(control.smallest * std::exp((b + 0.5) * width_));
    if (b > 0) edges_.push_back(mass_of_radius(control.smallest * std::exp(b * width_)));
  }
  means_.axes = {radius};
  means_.variables = {{"mean_droplet_number_size_spectrum", "m-3",
                       "domain mean number per volume of air and unit of ln r"},
                      {"mean_droplet_water_size_spectrum", "kg m-3",
                       "domain mean mass of water per volume of air and unit of ln r"}};
  if (!control.gridded) return;
  gridded_.axes = {radius, cell_axis(grid_, 2, "z_cell")};
  if (grid_.dimension == 3) gridded_.axes.push_back(cell_axis(grid_, 1, "y_cell"));
  gridded_.axes.push_back(cell_axis(grid_, 0, "x_cell"));
  gridded_.variables = {
      {"droplet_number_size_spectrum", "m-3", "number per volume of air and unit of ln r"},
      {"droplet_water_size_spectrum", "kg m-3",
       "mass of water per volume of air and unit of ln r"}};
}

std::size_t SizeSpectra::bin_of(double mass) const {
  return static_cast<std::size_t>(std::upper_bound(edges_.begin(), edges_.end(), mass) -
                                  edges_.begin());
}

/// In file order: z slowest, x fastest.
std::size_t SizeSpectra::cell_of(const parcels::Store& store, std::size_t p) const {
  const auto along = [&](int axis, double x) {
    const double place = std::floor((x - grid_.origin[axis]) / grid_.spacing[axis]);
    const auto last = static_cast<double>(grid_.cells[axis] - 1);
    return static_cast<std::size_t>(std::clamp(place, 0.0, last));
  };
  const int vertical = store.dimension() - 1;
  const std::size_t j = vertical == 2 ? along(1, store.position(1)[p]) : 0;
  return (along(2, store.position(vertical)[p]) * static_cast<std::size_t>(grid_.cells[1]) + j) *
             static_cast<std::size_t>(grid_.cells[0]) +
         along(0, store.position(0)[p]);
}

void SizeSpectra::measure(const Simulation& simulation,
                          std::vector<std::vector<double>>& values) const {
  const parcels::Store& store = simulation.store();
  const parcels::ItemLists& items = store.items();
  const double* mass = items.column(mass_);
  const auto bins = static_cast<std::size_t>(control_.bins);
  const auto cells = static_cast<std::size_t>(grid_.cells[0] * grid_.cells[1] * grid_.cells[2]);
  const std::size_t kept = control_.gridded ? cells : 0;
  std::vector<double> number(bins * kept), water(bins * kept), volume(kept);
  std::vector<double> all_number(bins), all_water(bins);
  for (std::size_t p = 0; p < store.size(); ++p) {
    const std::size_t cell = kept > 0 ? cell_of(store, p) : 0;
    if (kept > 0) volume[cell] += store.volume()[p];
    const std::int64_t end = items.begin()[p] + items.count()[p];
    for (std::int64_t i = items.begin()[p]; i < end; ++i) {
      const auto count = static_cast<double>(items.multiplicity()[i]);
      const std::size_t bin = bin_of(mass[i]);
      all_number[bin] += count;
      all_water[bin] += count * mass[i];
      if (kept == 0) continue;
      number[bin * cells + cell] += count;
      water[bin * cells + cell] += count * mass[i];
    }
  }
  for (std::size_t b = 0; b < bins; ++b) {
    for (std::vector<double>* sum : {&all_number, &all_water}) (*sum)[b] /= domain_volume_ * width_;
    for (std::size_t c = 0; c < kept; ++c)
      for (std::vector<double>* sum : {&number, &water})
        (*sum)[b * cells + c] /= volume[c] > 0 ? volume[c] * width_ : 1.0;
  }
  values.clear();
  if (kept > 0) {
    values.push_back(std::move(number));
    values.push_back(std::move(water));
  }
  values.push_back(std::move(all_number));
  values.push_back(std::move(all_water));
}

}  // namespace pileus::model

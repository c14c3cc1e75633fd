#include "model/slab_statistics.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "base/quantities.hpp"
#include "coupling/quantity_plan.hpp"

namespace pileus::model {
namespace {

constexpr const char* liquid_name = "mass_fraction_of_cloud_liquid_water_in_air";
constexpr const char* velocity_units = "m s-1";

using Factor = std::pair<std::string, int>;

/// "m s-2" as {m, 1}, {s, −2}; nothing where that does not say it all.
std::optional<std::vector<Factor>> factors_of(const std::string& units) {
  std::vector<Factor> factors;
  std::istringstream words(units);
  for (std::string word; words >> word;) {
    if (word == "1") continue;
    std::size_t letters = 0;
    while (letters < word.size() && std::isalpha(static_cast<unsigned char>(word[letters])) != 0)
      ++letters;
    const std::string exponent = word.substr(letters);
    const std::size_t sign = exponent.starts_with('-') ? 1 : 0;
    if (letters == 0 || exponent.size() - sign > 2 ||
        exponent.find_first_not_of("0123456789", sign) != std::string::npos ||
        (sign == 1 && exponent.size() == 1))
      return std::nullopt;
    factors.emplace_back(word.substr(0, letters), exponent.empty() ? 1 : std::stoi(exponent));
  }
  return factors;
}

}  // namespace

std::string product_of_units(const std::string& a, const std::string& b) {
  const auto first = factors_of(a), second = factors_of(b);
  if (!first || !second) return fmt::format("({}) ({})", a, b);
  std::vector<Factor> product;
  for (const auto* factors : {&*first, &*second})
    for (const Factor& factor : *factors) {
      bool known = false;
      for (Factor& other : product)
        if (other.first == factor.first) {
          other.second += factor.second;
          known = true;
        }
      if (!known) product.push_back(factor);
    }
  std::string text;
  for (const auto& [name, exponent] : product) {
    if (exponent == 0) continue;
    text += (text.empty() ? "" : " ") + name;
    if (exponent != 1) text += std::to_string(exponent);
  }
  return text.empty() ? "1" : text;
}

std::vector<SlabStatistics::Quantity> SlabStatistics::quantities_of(const parcels::Store& store) {
  std::vector<Quantity> list;
  const int dimension = store.dimension();
  for (int d = 0; d < dimension; ++d) {
    const bool up = d == dimension - 1, along_x = d == 0;
    list.push_back({up        ? "z_velocity"
                    : along_x ? "x_velocity"
                              : "y_velocity",
                    velocity_units,
                    up        ? "upward_air_velocity"
                    : along_x ? "x_wind"
                              : "y_wind",
                    -1, d});
  }
  list.push_back({"buoyancy", "m s-2", "", -1, -1});
  const std::vector<parcels::Scalar>& scalars = store.scalars();
  for (std::size_t s = 0; s < scalars.size(); ++s) {
    const parcels::Scalar& scalar = scalars[s];
    if (scalar.name == "buoyancy" || scalar.name == coupling::previous_height_name ||
        scalar.nature == parcels::Nature::extensive)
      continue;
    const pileus::Quantity* known = find_quantity(scalar.name);
    list.push_back({scalar.name, scalar.units,
                    known != nullptr ? std::string(known->standard_name) : std::string(),
                    static_cast<int>(s), -1});
  }
  return list;
}

SlabStatistics::SlabStatistics(const scene::Scene& scene, const parcels::Store& store)
    : bottom_(scene.domain.lower.back()),
      spacing_(scene.domain.extent.back() / scene.domain.cells.back()),
      cloud_threshold_(scene.diagnostics.cloud_threshold),
      liquid_(store.find_scalar(liquid_name)),
      quantities_(quantities_of(store)),
      sums_(layout(), static_cast<std::size_t>(scene.domain.cells.back()) + 1) {
  list_moments();
  if (!has_cloud()) return;
  list_set(SlabLayout::cloud, "cloud", "where cloud");
  list_set(SlabLayout::core, "core", "");
}

SlabLayout SlabStatistics::layout() const {
  SlabLayout layout;
  layout.variables = quantities_.size();
  layout.has_sets = has_cloud();
  for (std::size_t v = 0; v < quantities_.size(); ++v) {
    const Quantity& quantity = quantities_[v];
    const bool vertical = quantity.name == "z_velocity";
    if (vertical) layout.vertical = v;
    if (quantity.name == "buoyancy") layout.buoyancy = v;
    if (vertical || quantity.scalar >= 0) layout.of_sets.push_back(v);
  }
  return layout;
}

void SlabStatistics::add(output::Variable variable, Formula formula) {
  variables_.push_back(std::move(variable));
  formulas_.push_back(formula);
}

void SlabStatistics::list_moments() {
  using Form = Formula::Form;
  const SlabLayout& at = sums_.layout();
  for (std::size_t v = 0; v < quantities_.size(); ++v) {
    const Quantity& q = quantities_[v];
    add({q.name, q.units, "slab mean of " + q.name, q.standard_name, "area: mean"},
        {Form::plain, at.mean(v), 0});
    add({q.name + "_variance", product_of_units(q.units, q.units), "slab variance of " + q.name, "",
         "area: variance"},
        {Form::plain, at.variance(v), 0});
    if (v == at.vertical) {
      add({q.name + "_skewness", "1", "slab skewness of " + q.name, "", ""},
          {Form::skewness, at.third(), at.variance(v)});
      continue;
    }
    add({q.name + "_flux", product_of_units(q.units, velocity_units),
         "resolved vertical flux of " + q.name, "", "area: mean"},
        {Form::plain, at.flux(v), 0});
  }
}

void SlabStatistics::list_set(SlabLayout::Set set, const std::string& name,
                              const std::string& where) {
  using Form = Formula::Form;
  const SlabLayout& at = sums_.layout();
  const bool is_cloud = set == SlabLayout::cloud;
  const std::string means = where.empty() ? "" : "area: mean " + where;
  const std::string air = is_cloud ? "cloudy air" : "cloudy air more buoyant than its slab";
  add({name + "_fraction", "1", "share of " + air,
       is_cloud ? "cloud_area_fraction_in_atmosphere_layer" : "", "area: mean"},
      {Form::plain, at.fraction(set), 0});
  add({name + "_mass_flux", velocity_units,
       "share of " + air + " times its upward velocity above the slab mean", "", "area: mean"},
      {Form::plain, at.mass_flux(set), 0});
  for (std::size_t i = 0; i < at.of_sets.size(); ++i) {
    const Quantity& q = quantities_[at.of_sets[i]];
    add({q.name + "_in_" + name, q.units, "mean " + q.name + " of " + air, q.standard_name, means},
        {Form::ratio, at.sum(set, i), at.fraction(set)});
  }
  add({"buoyancy_excess_in_" + name, "m s-2", "mean buoyancy of " + air + " over the slab mean", "",
       means},
      {Form::ratio, at.excess(set), at.fraction(set)});
}

void SlabStatistics::measure(Simulation& simulation) {
  const parcels::Store& store = simulation.store();
  SlabState state;
  state.parcels = store.size();
  state.bottom = bottom_;
  state.spacing = spacing_;
  state.height = store.position(simulation.dimension() - 1);
  state.volume = store.volume();
  state.cloud_threshold = cloud_threshold_;
  for (const Quantity& q : quantities_)
    state.variables.push_back(q.scalar >= 0      ? store.scalar(q.scalar)
                              : q.direction >= 0 ? simulation.velocity(q.direction)
                                                 : simulation.buoyancy());
  if (has_cloud()) state.liquid = store.scalar(liquid_);
  sums_.measure(state);
}

int SlabStatistics::find(const std::string& name) const {
  for (std::size_t i = 0; i < variables_.size(); ++i)
    if (variables_[i].name == name) return static_cast<int>(i);
  return -1;
}

void SlabStatistics::profile(std::span<const double> moments, int number,
                             std::vector<double>& values) const {
  const Formula& formula = formulas_[static_cast<std::size_t>(number)];
  const std::size_t n = levels();
  values.resize(n);
  const double *a = moments.data() + formula.moment * n, *b = moments.data() + formula.divisor * n;
  for (std::size_t k = 0; k < n; ++k) switch (formula.form) {
      case Formula::Form::plain:
        values[k] = a[k];
        break;
      case Formula::Form::ratio:
        values[k] = b[k] > 0 ? a[k] / b[k] : std::numeric_limits<double>::quiet_NaN();
        break;
      case Formula::Form::skewness:
        values[k] =
            b[k] > 0 ? a[k] / std::pow(b[k], 1.5) : std::numeric_limits<double>::quiet_NaN();
    }
}

Profile SlabStatistics::profile(int number, std::vector<double>& values) const {
  profile(moments(), number, values);
  return on_levels(values);
}

}  // namespace pileus::model

#include "scene/field_sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/units.hpp"
#include "pileus/philox.hpp"
#include "scene/problems.hpp"

namespace pileus::scene {

FieldSampler::FieldSampler(const FieldDescription& field, const Vocabulary& vocabulary,
                           const Domain& domain)
    : field_(field), vocabulary_(vocabulary), domain_(domain) {
  if (field.form == FieldDescription::Form::file) gridded_.emplace(field, domain);
  if (field.form != FieldDescription::Form::formula) return;
  try {
    compiled_ = std::make_unique<const PointFormula>(
        field.formula, std::vector<std::string>{"x", "y", "z"}, vocabulary);
  } catch (const FormulaProblem& problem) {
    throw Error(ExitCode::usage, fmt::format("{}: error: {}", describe(field.where), problem.text));
  }
}

FieldSampler::FieldSampler(const FieldDescription& field, const Scene& scene)
    : FieldSampler(field, Vocabulary{scene.constants, scene.formulas}, scene.domain) {}

FieldSampler::~FieldSampler() = default;
FieldSampler::FieldSampler(FieldSampler&&) noexcept = default;
FieldSampler& FieldSampler::operator=(FieldSampler&&) noexcept = default;

double FieldSampler::interpolate(const Profile& profile, double z) {
  const std::vector<double>& h = profile.height;
  if (z <= h.front()) return profile.value.front();
  if (z >= h.back()) return profile.value.back();
  const auto high = static_cast<std::size_t>(std::upper_bound(h.begin(), h.end(), z) - h.begin());
  const double weight = (z - h[high - 1]) / (h[high] - h[high - 1]);
  return (1 - weight) * profile.value[high - 1] + weight * profile.value[high];
}

double FieldSampler::noise(double x, double y, double z) const {
  const auto vertical = static_cast<std::size_t>(domain_.dimension - 1);
  const double point[3] = {x, domain_.dimension == 3 ? y : z, z};
  std::uint64_t cell = 0, stride = 1;
  double centre = 0;
  for (std::size_t d = 0; d <= vertical; ++d) {
    const std::int64_t n = domain_.cells[d];
    const double spacing = domain_.extent[d] / static_cast<double>(n);
    auto index = static_cast<std::int64_t>(std::floor((point[d] - domain_.lower[d]) / spacing));
    if (d == vertical) {
      index = std::clamp<std::int64_t>(index, 0, n - 1);
      centre = domain_.lower[d] + (static_cast<double>(index) + 0.5) * spacing;
    } else {
      index = ((index % n) + n) % n;
    }
    cell += static_cast<std::uint64_t>(index) * stride;
    stride *= static_cast<std::uint64_t>(n);
  }
  const Noise& noise = *field_.noise;
  if (centre < noise.bottom || centre > noise.top) return 0;
  double draw = 0;
  draw_uniform(DrawKey{.seed = noise.seed, .uid = cell}, 1, &draw);
  return noise.amplitude * (2 * draw - 1);
}

void FieldSampler::sample_range(std::size_t begin, std::size_t end, const double* x,
                                const double* y, const double* z, double* out,
                                PointFormula* formula) const {
  using Form = FieldDescription::Form;
  const bool three = domain_.dimension == 3;
  for (std::size_t i = begin; i < end; ++i) {
    const double yi = three ? y[i] : 0.0;
    double value = field_.constant;
    if (field_.form == Form::formula)
      value = (*formula)(std::array{x[i], yi, z[i]}.data());
    else if (field_.form == Form::profile)
      value = interpolate(field_.profile, z[i]);
    else if (field_.form == Form::file)
      value = (*gridded_)(x[i], yi, z[i]);
    if (field_.noise) value += noise(x[i], yi, z[i]);
    if (!std::isfinite(value))
      throw Error(
          ExitCode::usage,
          fmt::format("{}: error: the field is {} at x = {} m, y = {} m, z = {} m",
                      describe(field_.where), std::isnan(value) ? "not a number" : "infinite",
                      shortest(x[i]), shortest(yi), shortest(z[i])));
    out[i] = value;
  }
}

void FieldSampler::sample(std::size_t n, const double* x, const double* y, const double* z,
                          double* out) const {
  // muParser keeps its stack in the parser: every thread works with a copy of its own. The copies
  // are made here, by one thread: constructing parsers changes data they all share.
  std::vector<std::unique_ptr<PointFormula>> copies(
      static_cast<std::size_t>(std::max(1, omp_get_max_threads())));
  if (compiled_)
    for (auto& copy : copies) copy = std::make_unique<PointFormula>(*compiled_);
  parallel_chunks(n, [&](std::size_t begin, std::size_t end) {
    sample_range(begin, end, x, y, z, out,
                 copies[static_cast<std::size_t>(omp_get_thread_num())].get());
  });
}

std::optional<double> FieldSampler::uniform_value() const {
  if (field_.form != FieldDescription::Form::constant || field_.noise) return std::nullopt;
  return field_.constant;
}

bool FieldSampler::height_alone() const {
  if (field_.noise || gridded_) return false;
  return !compiled_ || (!compiled_->uses(0) && !compiled_->uses(1));
}

}  // namespace pileus::scene

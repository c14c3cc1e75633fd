#include "study/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "model/record.hpp"
#include "model/table_column.hpp"
#include "output/read_fields.hpp"
#include "study/field_norm.hpp"

namespace pileus::study {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const ErrorNorm& norm, const std::string& what, const std::string& word,
                         const std::vector<std::string>& known) {
  const std::string nearest = nearest_word(word, known);
  throw Error(
      ExitCode::usage,
      fmt::format("{}: error: this run has no {} '{}'; {}", describe(norm.where), what, word,
                  nearest.empty() ? fmt::format("it has {}", fmt::join(known, ", "))
                                  : fmt::format("did you mean '{}'?", nearest)));
}

/// One diagnostic of a run over time, as the run's own record of it.
model::Record record_of(const fs::path& folder, const ErrorNorm& norm) {
  const output::ResultsFile file(folder / "series.nc");
  const output::StoredVariable* variable = file.find(norm.diagnostic);
  if (variable == nullptr) {
    std::vector<std::string> names;
    for (const output::StoredVariable& v : file.variables())
      if (v.name != "time") names.push_back(v.name);
    refuse(norm, "diagnostic", norm.diagnostic, names);
  }
  model::Record record({{norm.diagnostic, variable->units, variable->long_name, false}});
  const std::vector<double> times = file.read("time"), values = file.read(norm.diagnostic);
  for (std::size_t i = 0; i < times.size(); ++i) record.append(times[i], {values[i]});
  return record;
}

double statistic_of(const fs::path& folder, const ErrorNorm& norm) {
  return record_of(folder, norm)
      .statistic(0, norm.statistic, norm.at, norm.from)
      .value_or(not_a_number);
}

double difference(double value, double reference, bool relative) {
  const double error = std::abs(value - reference);
  return relative ? error / std::abs(reference) : error;
}

double diagnostic_error(const ErrorNorm& norm, const fs::path& folder, const fs::path& finest) {
  const double reference =
      norm.reference == ErrorNorm::Reference::finest ? statistic_of(finest, norm) : norm.exact;
  return difference(statistic_of(folder, norm), reference, norm.relative);
}

double published_series_error(const ErrorNorm& norm, const fs::path& folder) {
  const std::vector<double> times =
      model::read_table_column(norm.file, norm.time_column, describe(norm.where));
  const std::vector<double> values =
      model::read_table_column(norm.file, norm.column, describe(norm.where));
  const model::Record record = record_of(folder, norm);
  double sum = 0, scale = 0;
  for (std::size_t i = 0; i < std::min(times.size(), values.size()); ++i) {
    const double miss = record.at(0, times[i]) - values[i];
    sum += miss * miss;
    scale += values[i] * values[i];
  }
  return std::sqrt(sum / scale);
}

}  // namespace

std::vector<double> measure_errors(const Study& study, const fs::path& folder,
                                   const fs::path& finest) {
  std::vector<double> errors;
  for (const ErrorNorm& norm : study.errors) {
    // The finest run itself is right by definition, which says nothing.
    const bool unknown = norm.needs_finest() && (finest.empty() || fs::equivalent(folder, finest));
    if (unknown) {
      errors.push_back(not_a_number);
    } else if (!norm.field.empty()) {
      const GriddedField field = read_field(folder, norm.field),
                         right = read_field(finest, norm.field);
      errors.push_back(norm.bins > 0 ? histogram_error(field, right, norm)
                                     : field_error(field, right));
    } else if (!norm.file.empty()) {
      errors.push_back(published_series_error(norm, folder));
    } else {
      errors.push_back(diagnostic_error(norm, folder, finest));
    }
  }
  return errors;
}

std::vector<double> errors_of_numbers(const Study& study, const RunOutcome& outcome) {
  std::vector<double> errors;
  for (const ErrorNorm& norm : study.errors) {
    const auto number = outcome.numbers.find(norm.diagnostic);
    if (number == outcome.numbers.end()) {
      std::vector<std::string> names;
      for (const auto& [name, value] : outcome.numbers) names.push_back(name);
      refuse(norm, "number", norm.diagnostic, names);
    }
    errors.push_back(difference(number->second, norm.exact, norm.relative));
  }
  return errors;
}

}  // namespace pileus::study

#include "output/field_file.hpp"

#include <utility>

#include "output/xdmf.hpp"

namespace pileus::output {
namespace {

/// Both ends of every record's interval, as CF wants them (7.1): units are those of time.
VariableSet interval_bounds() {
  return {{{{"nv", "", "start and end of an interval"}, {0, 1}}}, {{time_bounds_name, "", ""}}};
}

}  // namespace

FieldFile::FieldFile(std::filesystem::path path, std::vector<Axis> axes,
                     std::vector<Variable> variables, Provenance provenance, Encoding encoding,
                     Start start, VariableSet ground)
    : records_(std::move(path), {std::move(axes), std::move(variables)}, std::move(ground),
               std::move(provenance), encoding, start) {
  if (start.kind == Start::Kind::resume && !records_.times().empty()) write_sidecar();
}

void FieldFile::append(double time, std::span<const std::vector<double>> values) {
  records_.append(time, values);
  write_sidecar();
}

void FieldFile::write_sidecar() const {
  std::filesystem::path sidecar = records_.path();
  sidecar.replace_extension(".xmf");
  write_field_sidecar(sidecar, records_.path(), records_.axes(), records_.variables(),
                      records_.encoding(), records_.times());
}

ProfileFile::ProfileFile(std::filesystem::path path, Axis height, std::vector<Variable> variables,
                         Provenance provenance, Start start, bool intervals)
    : RecordFile(std::move(path), {{std::move(height)}, std::move(variables)},
                 intervals ? interval_bounds() : VariableSet{}, std::move(provenance),
                 Encoding{.exact = true}, start) {}

SeriesFile::SeriesFile(std::filesystem::path path, std::vector<Variable> variables,
                       Provenance provenance, Start start)
    : RecordFile(std::move(path), {{}, std::move(variables)}, {}, std::move(provenance),
                 Encoding{.exact = true}, start) {}

void SeriesFile::append(double time, std::span<const double> values) {
  std::vector<std::vector<double>> columns;
  for (const double value : values) columns.push_back({value});
  RecordFile::append(time, columns);
}

}  // namespace pileus::output

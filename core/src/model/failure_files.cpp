#include "model/failure_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/version.hpp"
#include "coupling/failure.hpp"
#include "output/failure_bundle.hpp"

namespace pileus::model {
namespace {

output::NamedData operator_bundle(const coupling::FailureBundle& bundle) {
  output::NamedData data;
  data.texts = {{"operator", bundle.operator_name},
                {"operator_id", bundle.operator_id},
                {"operator_version", bundle.operator_version},
                {"library", bundle.library},
                {"toolchain", bundle.toolchain},
                {"phase", bundle.phase},
                {"reason", bundle.reason},
                {"quantity", bundle.quantity}};
  data.counters = {{"step", {bundle.step}},     {"seed", {bundle.seed}},
                   {"stream", {bundle.stream}}, {"call", {bundle.call}},
                   {"uid", {bundle.uid}},       {"attempts", {std::uint64_t(bundle.attempts)}},
                   {"uids", bundle.uids}};
  data.counters["active"].assign(bundle.active.begin(), bundle.active.end());
  data.arrays = {{"time", {bundle.time}},
                 {"dt", {bundle.dt}},
                 {"value", {bundle.value}},
                 {"block", {static_cast<double>(bundle.block)}}};
  for (const auto& parameter : bundle.parameters) {
    data.arrays["parameter/" + parameter.name] = {parameter.number};
    if (!parameter.list.empty()) data.arrays["parameter/" + parameter.name] = parameter.list;
    if (!parameter.text.empty()) data.texts["parameter/" + parameter.name] = parameter.text;
  }
  for (const auto& column : bundle.columns) data.arrays["column/" + column.name] = column.values;
  return data;
}

output::NamedData state_bundle(const Error& error, const Simulation& simulation) {
  output::NamedData data;
  const parcels::Store& store = simulation.store();
  data.texts["reason"] = error.what();
  data.counters["step"] = {simulation.step()};
  data.counters["uids"].assign(store.uid(), store.uid() + store.size());
  data.arrays["time"] = {simulation.time()};
  data.arrays["dt"] = {simulation.last_dt()};
  for (int c = 0; c < store.state_columns(); ++c)
    data.arrays["column/" + store.column_name(c)].assign(store.column(c),
                                                         store.column(c) + store.size());
  return data;
}

/// A label of the scene as a part of a file name: slashes would ask for folders.
std::string file_part(std::string label) {
  std::replace(label.begin(), label.end(), '/', '_');
  return label;
}

}  // namespace

std::string write_failure(const std::filesystem::path& folder, const Error& error,
                          const Simulation& simulation, const std::string& scene) {
  const auto* failure = dynamic_cast<const coupling::OperatorFailure*>(&error);
  output::NamedData data =
      failure ? operator_bundle(failure->bundle()) : state_bundle(error, simulation);
  data.texts["scene"] = scene;
  data.texts["version"] = std::string(build_record().version);
  data.texts["commit"] = std::string(build_record().commit);
  const std::filesystem::path path =
      folder / fmt::format("failure-{}-{}.h5",
                           failure ? file_part(failure->bundle().operator_name) : "state",
                           simulation.step());
  output::write_failure_bundle(path, data);
  return path.string();
}

}  // namespace pileus::model

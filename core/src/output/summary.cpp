#include "output/summary.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>

#include "output/posix_file.hpp"

namespace pileus::output {

namespace {

using Json = nlohmann::ordered_json;

Json finite(std::string_view name, double value) {
  if (!std::isfinite(value))
    throw std::invalid_argument(std::string(name) + " has to be a finite number");
  return value;
}

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json number_or_null(const std::optional<double>& value) {
  return value ? number_or_null(*value) : Json(nullptr);
}

const char* name_of(Summary::Status status) {
  switch (status) {
    case Summary::Status::done:
      return "done";
    case Summary::Status::stopped:
      return "stopped";
    case Summary::Status::failed:
      return "failed";
  }
  throw std::invalid_argument("unknown status");
}

/// An object with one entry per element, under its name; never null, even when empty.
template <class Element, class Entry>
Json by_name(const std::vector<Element>& elements, Entry&& entry) {
  Json object = Json::object();
  for (const Element& element : elements) object[element.name] = entry(element);
  return object;
}

Json phases_of(const Summary& summary) {
  return by_name(summary.phases, [](const PhaseSummary& phase) {
    return Json{{"seconds", finite("phase time", phase.seconds)},
                {"share", number_or_null(phase.share)},
                {"calls", phase.calls}};
  });
}

Json diagnostics_of(const Summary& summary) {
  return by_name(summary.diagnostics, [](const DiagnosticSummary& diagnostic) {
    Json entry{{"units", diagnostic.units},
               {"initial", number_or_null(diagnostic.initial)},
               {"final", number_or_null(diagnostic.final)},
               {"min", number_or_null(diagnostic.min)},
               {"max", number_or_null(diagnostic.max)},
               {"mean", number_or_null(diagnostic.mean)}};
    if (diagnostic.relative_change)
      entry["relative_change"] = number_or_null(*diagnostic.relative_change);
    return entry;
  });
}

Json calls_of(const CallSummary& one) {
  return {{"calls", one.calls},
          {"skipped", one.skipped},
          {"skipped_by",
           {{"epoch", one.skipped_by_epoch},
            {"bounds", one.skipped_by_bounds},
            {"list", one.skipped_by_list}}},
          {"audited", one.audited},
          {"seconds", finite("time of calls", one.seconds)},
          {"share", number_or_null(one.share)},
          {"seconds_saved", number_or_null(one.seconds_saved)},
          {"retries", one.retries},
          {"repairs", one.repairs}};
}

Json effects_of(const Summary& summary) {
  return by_name(summary.effects, [](const EffectSummary& effect) {
    Json entry{{"verdict", effect.verdict}, {"reason", effect.reason}};
    entry.update(calls_of(effect.calls));
    return entry;
  });
}

Json operators_of(const Summary& summary) {
  return by_name(summary.operators, [](const OperatorSummary& one) { return calls_of(one.calls); });
}

Json budgets_of(const Summary& summary) {
  return by_name(summary.budgets, [](const BudgetSummary& budget) {
    return Json{{"units", budget.units},
                {"initial", number_or_null(budget.initial)},
                {"final", number_or_null(budget.final)},
                {"sources", number_or_null(budget.sources)},
                {"defect", number_or_null(budget.defect)}};
  });
}

Json expect_of(const Summary& summary) {
  Json list = Json::array();
  for (const ExpectSummary& one : summary.expect)
    list.push_back(
        {{"diagnostic", one.diagnostic},
         {"statistic", one.statistic},
         {"at_s", number_or_null(one.at)},
         {"from_s", number_or_null(one.from)},
         {"value", number_or_null(one.value)},
         {"bound", {{"low", number_or_null(one.low)}, {"high", number_or_null(one.high)}}},
         {"passed", one.passed},
         {"source", one.source}});
  return list;
}

Json outputs_of(const Summary& summary) {
  Json list = Json::array();
  for (const OutputSummary& one : summary.outputs)
    list.push_back({{"path", one.path}, {"content", one.content}, {"records", one.records}});
  return list;
}

/// Texts from outside may hold bytes that are not UTF-8; they must not lose the whole summary.
std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

void CallSummary::add(const CallSummary& other) {
  calls += other.calls;
  skipped += other.skipped;
  seconds += other.seconds;
  retries += other.retries;
  repairs += other.repairs;
  share += other.share;
  skipped_by_epoch += other.skipped_by_epoch;
  skipped_by_bounds += other.skipped_by_bounds;
  skipped_by_list += other.skipped_by_list;
  audited += other.audited;
  seconds_saved += other.seconds_saved;
}

std::string to_json(const Summary& s) {
  Json json;
  json["status"] = name_of(s.status);
  json["message"] = s.message;
  json["scene"] = s.scene;
  json["title"] = s.title;
  json["dimension"] = s.dimension;
  json["threads"] = s.threads;
  json["steps"] = s.steps;
  json["simulated_time_s"] = finite("simulated_time_s", s.simulated_time);
  json["wall_s"] = finite("wall_s", s.wall);
  json["core_s"] = finite("core_s", s.core);
  json["parcels"] = {{"initial", s.parcels_initial},
                     {"final", s.parcels_final},
                     {"mean", number_or_null(s.parcels_mean)}};
  json["ns_per_parcel_step"] = number_or_null(s.ns_per_parcel_step);
  json["bytes_per_parcel"] = number_or_null(s.bytes_per_parcel);
  json["peak_memory_bytes"] = s.peak_memory;
  json["phases"] = phases_of(s);
  json["diagnostics"] = diagnostics_of(s);
  json["effects"] = effects_of(s);
  json["operators"] = operators_of(s);
  json["watch"] = {{"checks", s.watch.checks}, {"seconds", finite("watch", s.watch.seconds)}};
  json["left_out"] = {{"bytes_per_parcel", number_or_null(s.left_out.bytes_per_parcel)},
                      {"core_s", number_or_null(s.left_out.seconds)}};
  json["budgets"] = budgets_of(s);
  json["expect"] = expect_of(s);
  json["state_sha256"] = s.state_sha256;
  json["seeds"] = Json(Json::object());
  for (const auto& [name, seed] : s.seeds) json["seeds"][name] = seed;
  json["version"] = s.version;
  json["commit"] = s.commit;
  json["compiler"] = s.compiler;
  json["libraries"] = Json(Json::object());
  for (const auto& [name, version] : s.libraries) json["libraries"][name] = version;
  json["directory"] = s.directory;
  json["outputs"] = outputs_of(s);
  return text_of(json);
}

std::string to_json(const RunStatus& s) {
  Json json;
  json["state"] = s.state;
  json["scene"] = s.scene;
  json["pid"] = s.pid;
  json["time_s"] = finite("time_s", s.time);
  json["end_s"] = finite("end_s", s.end);
  json["percent"] = s.end > 0 ? Json(100 * s.time / s.end) : Json(nullptr);
  json["step"] = s.step;
  json["dt_s"] = finite("dt_s", s.dt);
  json["parcels"] = s.parcels;
  json["wall_s"] = finite("wall_s", s.wall);
  json["eta_s"] = number_or_null(s.eta);
  json["steps_per_second"] = number_or_null(s.steps_per_second);
  json["ns_per_parcel_step"] = number_or_null(s.ns_per_parcel_step);
  return text_of(json);
}

void write_summary(const std::filesystem::path& path, const Summary& summary) {
  replace_file(path, to_json(summary));
}

void write_status(const std::filesystem::path& path, const RunStatus& status) {
  replace_file(path, to_json(status));
}

}  // namespace pileus::output

#include "study/sweep_collection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

#include "base/version.hpp"
#include "output/ensemble_file.hpp"
#include "output/read_fields.hpp"
#include "study/outcome.hpp"
#include "study/scene_settings.hpp"
#include "study/sweep_files.hpp"
#include "study/sweep_picture.hpp"
#include "study/sweep_statistics.hpp"

namespace pileus::study {

namespace fs = std::filesystem;

namespace {

bool is_done(const SweepResult& result, std::size_t member) {
  return result.records[member].status == MemberRecord::Status::done;
}

/// The file of a member that is done and has it.
std::optional<output::ResultsFile> open_stream(const SweepResult& result, std::size_t member,
                                               const std::string& file) {
  const fs::path path = member_folder(result.directory, member) / file;
  if (!is_done(result, member) || !fs::exists(path)) return std::nullopt;
  return std::optional<output::ResultsFile>(std::in_place, path);
}

/// Variables over time, and over height or the like besides.
bool is_over_time(const output::StoredVariable& variable) {
  return variable.name != "time" && !variable.dimensions.empty() &&
         variable.dimensions.front() == "time" && variable.dimensions.size() <= 2;
}

std::vector<std::vector<double>> times_of(const SweepResult& result, const std::string& file) {
  std::vector<std::vector<double>> times;
  for (std::size_t m = 0; m < result.records.size(); ++m)
    if (const auto opened = open_stream(result, m, file)) times.push_back(opened->read("time"));
  return times;
}

/// Fills a stream, member by member.
class StreamReader {
 public:
  StreamReader(const SweepResult& result, CollectedStream& stream)
      : members_(result.records.size()), stream_(stream) {}

  void read(const output::ResultsFile& file, std::size_t member) {
    const std::vector<double> times = file.read("time");
    if (times.empty()) return;
    if (times != stream_.axes.front().values) stream_.as_stored = false;
    for (const output::StoredVariable& variable : file.variables())
      if (is_over_time(variable)) add_axis(file, variable);
    for (const output::StoredVariable& variable : file.variables()) {
      if (!is_over_time(variable) || variable.dimensions.size() != stream_.axes.size()) continue;
      std::vector<double> heights;
      if (variable.dimensions.size() == 2) heights = file.read(variable.dimensions.back());
      put(variable, member, onto_axes(variable, file.read(variable.name), times, heights));
    }
  }

 private:
  /// The first member that has an axis decides where its nodes are.
  void add_axis(const output::ResultsFile& file, const output::StoredVariable& variable) {
    if (variable.dimensions.size() < 2 || stream_.axes.size() > 1 || !stream_.variables.empty())
      return;
    const output::StoredVariable* axis = file.find(variable.dimensions.back());
    if (axis == nullptr) return;  // a dimension without nodes
    stream_.axes.push_back({{axis->name, axis->units, axis->long_name, ""},
                            file.read(axis->name),
                            axis->name == "z" ? "up" : ""});
  }

  std::vector<double> onto_axes(const output::StoredVariable& variable, std::vector<double> values,
                                const std::vector<double>& times,
                                const std::vector<double>& heights) {
    const std::size_t width = std::max<std::size_t>(heights.size(), 1);
    std::size_t rows = times.size(), columns = width;
    const std::vector<double>& wanted = stream_.axes.front().values;
    if (times != wanted) {
      values = interpolate_rows(times, values, width, wanted);
      rows = wanted.size();
    }
    if (variable.dimensions.size() < 2 || heights == stream_.axes[1].values) return values;
    stream_.as_stored = false;
    const std::vector<double>& levels = stream_.axes[1].values;
    std::vector<double> regridded;
    for (std::size_t row = 0; row < rows; ++row) {
      const std::span<const double> profile(values.data() + row * columns, columns);
      const std::vector<double> there = interpolate_rows(heights, profile, 1, levels);
      regridded.insert(regridded.end(), there.begin(), there.end());
    }
    return regridded;
  }

  void put(const output::StoredVariable& variable, std::size_t member,
           const std::vector<double>& values) {
    const auto known =
        std::find_if(stream_.variables.begin(), stream_.variables.end(),
                     [&](const output::Variable& one) { return one.name == variable.name; });
    const auto v = static_cast<std::size_t>(known - stream_.variables.begin());
    const std::size_t size = stream_.record_size();
    if (known == stream_.variables.end()) {
      stream_.variables.push_back({variable.name, variable.units, variable.long_name, ""});
      stream_.values.emplace_back(members_ * size, not_a_number);
      stream_.present.emplace_back(members_, false);
    }
    if (values.size() != size) return;  // other axes than the rest of the file
    std::copy(values.begin(), values.end(),
              stream_.values[v].begin() + static_cast<std::ptrdiff_t>(member * size));
    stream_.present[v][member] = true;
  }

  std::size_t members_;
  CollectedStream& stream_;
};

std::vector<std::string> axis_names(const CollectedStream& stream) {
  std::vector<std::string> names;
  for (const output::Axis& axis : stream.axes) names.push_back(axis.variable.name);
  return names;
}

void add_statistics(const CollectedStream& stream, std::size_t v, std::size_t members,
                    output::EnsembleContent& content) {
  const output::Variable& of = stream.variables[v];
  const std::size_t size = stream.record_size();
  const std::vector<std::string> axes = axis_names(stream);
  const auto make = [&](const std::string& suffix, const std::string& words,
                        const std::string& method) {
    return output::StatisticVariable{
        {stream.prefix + of.name + "_" + suffix, of.units,
         words + " of " + (of.long_name.empty() ? of.name : of.long_name), ""},
        axes,
        std::vector<double>(size),
        method};
  };
  std::vector<output::StatisticVariable> all = {
      make("mean", "mean over the members", "member: mean"),
      make("std", "standard deviation over the members", "member: standard_deviation")};
  for (const int percent : percentiles)  // CF knows the median only
    all.push_back(make(fmt::format("p{:02}", percent),
                       fmt::format("percentile {} over the members", percent),
                       percent == 50 ? "member: median" : ""));
  std::vector<double> column;
  for (std::size_t i = 0; i < size; ++i) {
    column.clear();
    for (std::size_t m = 0; m < members; ++m) column.push_back(stream.values[v][m * size + i]);
    const MemberStatistics statistics = statistics_of(column);
    all[0].values[i] = statistics.mean;
    all[1].values[i] = statistics.deviation;
    for (std::size_t p = 0; p < percentiles.size(); ++p)
      all[p + 2].values[i] = statistics.at_percentile[p];
  }
  std::move(all.begin(), all.end(), std::back_inserter(content.statistics));
}

void add_stream(const SweepRequest& request, const SweepResult& result,
                const CollectedStream& stream, output::EnsembleContent& content) {
  content.axes.insert(content.axes.end(), stream.axes.begin(), stream.axes.end());
  const std::size_t members = result.records.size();
  for (std::size_t v = 0; v < stream.variables.size(); ++v) {
    output::MemberVariable variable{
        stream.variables[v], axis_names(stream), {}, {}, stream.variables[v].name};
    variable.variable.name = stream.prefix + variable.source_name;
    if (stream.as_stored && !request.copy) {
      for (std::size_t m = 0; m < members; ++m)
        variable.sources.push_back(
            stream.present[v][m] ? "members/" + index_text(m) + "/" + stream.file : "");
    } else {
      variable.values = stream.values[v];
    }
    content.variables.push_back(std::move(variable));
    add_statistics(stream, v, members, content);
  }
}

/// A name that nothing else in the file has.
std::string free_name(const std::string& wanted, const output::EnsembleContent& content) {
  const auto taken = [&](const std::string& name) {
    const auto is_it = [&](const auto& one) { return one.variable.name == name; };
    constexpr std::array<const char*, 6> reserved = {"member", "scene",  "sweep",
                                                     "seed",   "status", "wall_time"};
    return std::find(reserved.begin(), reserved.end(), name) != reserved.end() ||
           std::any_of(content.axes.begin(), content.axes.end(), is_it) ||
           std::any_of(content.variables.begin(), content.variables.end(), is_it) ||
           std::any_of(content.statistics.begin(), content.statistics.end(), is_it) ||
           std::any_of(content.numbers.begin(), content.numbers.end(), is_it) ||
           std::any_of(content.words.begin(), content.words.end(), is_it);
  };
  std::string name = identifier(wanted);
  while (taken(name)) name = "parameter_" + name;
  return name;
}

void add_parameters(const SweepResult& result, output::EnsembleContent& content) {
  const Ensemble& ensemble = result.ensemble;
  for (std::size_t p = 0; p < ensemble.parameters.size(); ++p) {
    std::string keys;
    for (const std::string& key : ensemble.parameters[p].keys)
      keys += (keys.empty() ? "" : ", ") + key;
    output::Variable variable{free_name(ensemble.parameters[p].name, content), "",
                              "swept parameter " + keys, ""};
    if (auto numbered = numbers_of(ensemble, p)) {
      variable.units = numbered->unit;
      content.numbers.push_back({std::move(variable), std::move(numbered->numbers)});
      continue;
    }
    output::WordColumn words{std::move(variable), {}};
    for (const Member& member : ensemble.members) words.values.push_back(member.values[p].text);
    content.words.push_back(std::move(words));
  }
  output::NumberColumn seeds{{"seed", "1", "seed of the member", ""}, {}, true},
      walls{{"wall_time", "s", "wall time of the member", ""}, {}};
  output::WordColumn status{{"status", "", "what became of the member", ""}, {}};
  for (std::size_t m = 0; m < ensemble.members.size(); ++m) {
    if (const auto& seed = ensemble.members[m].seed)
      seeds.values.push_back(static_cast<double>(*seed));
    walls.values.push_back(result.records[m].wall);
    status.values.push_back(word_of(result.records[m].status));
  }
  if (!ensemble.sweep.seeds.empty()) content.numbers.push_back(std::move(seeds));
  content.numbers.push_back(std::move(walls));
  content.words.push_back(std::move(status));
}

output::Provenance provenance_of(const SweepResult& result, bool referred) {
  const Sweep& sweep = result.ensemble.sweep;
  output::Provenance provenance;
  provenance.title = sweep.title;
  provenance.source = fmt::format("Pileus {} ({})", build_record().version, build_record().commit);
  provenance.history = fmt::format("{} pileus sweep {}", date_now(), sweep.path);
  provenance.scene = result.ensemble.members.front().resolved;  // the others' are in their files
  if (referred)
    provenance.attributes["comment"] =
        "Variables over members refer to the files below members/ and are missing without them.";
  return provenance;
}

void write_file(const SweepRequest& request, const SweepResult& result,
                const std::vector<CollectedStream>& streams) {
  output::EnsembleContent content;
  content.members = result.records.size();
  std::ifstream file(result.ensemble.sweep.path);
  content.sweep = std::string(std::istreambuf_iterator<char>(file), {});
  for (const CollectedStream& stream : streams) add_stream(request, result, stream, content);
  add_parameters(result, content);
  const bool referred =
      std::any_of(content.variables.begin(), content.variables.end(),
                  [](const output::MemberVariable& one) { return !one.sources.empty(); });
  output::write_ensemble(result.directory / "ensemble.nc", content,
                         provenance_of(result, referred));
}

/// Says which folders below members/ belong to no member, for the sweep had more of them once.
void name_former_members(const SweepResult& result, std::ostream& out) {
  constexpr std::size_t most_named = 8;
  const fs::path members = result.directory / "members";
  std::vector<std::string> former;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(members, none)) {
    const std::string name = entry.path().filename().string();
    const bool is_index = name.size() >= 4 && name.size() < 10 &&
                          name.find_first_not_of("0123456789") == std::string::npos;
    if (is_index && std::stoul(name) >= result.records.size()) former.push_back(name);
  }
  if (former.empty()) return;
  std::sort(former.begin(), former.end());
  std::string names;
  for (std::size_t i = 0; i < std::min(former.size(), most_named); ++i)
    names += (i == 0 ? "" : ", ") + former[i];
  if (former.size() > most_named) names += fmt::format(" and {} more", former.size() - most_named);
  out << fmt::format("{}: {} of an earlier, larger sweep; kept, and not collected\n",
                     members.string(), names);
}

}  // namespace

std::size_t CollectedStream::record_size() const {
  std::size_t size = 1;
  for (const output::Axis& axis : axes) size *= axis.values.size();
  return size;
}

std::optional<CollectedStream> collect_stream(const SweepResult& result, const std::string& file,
                                              const std::string& prefix, double every) {
  CollectedStream stream;
  stream.file = file;
  stream.prefix = prefix;
  std::vector<double> times = common_times(times_of(result, file), every);
  if (times.empty()) return std::nullopt;
  stream.axes.push_back(
      {{prefix + "time", output::time_units, "time since the start of the simulation", "time"},
       std::move(times)});
  StreamReader reader(result, stream);
  for (std::size_t m = 0; m < result.records.size(); ++m)
    if (const auto opened = open_stream(result, m, file)) reader.read(*opened, m);
  if (stream.variables.empty()) return std::nullopt;
  return stream;
}

void collect(const SweepRequest& request, const SweepResult& result, std::ostream& out) {
  write_member_table(result);
  std::string made = "sweep.json, members.tsv, members.csv";
  double series_every = 0, profiles_every = 0;
  for (const Member& member : result.ensemble.members) {
    series_every = std::max(series_every, member.series_every);
    profiles_every = std::max(profiles_every, member.profiles_every);
  }
  std::vector<CollectedStream> streams;
  if (auto series = collect_stream(result, "series.nc", "", series_every))
    streams.push_back(std::move(*series));
  const bool has_series = !streams.empty();
  if (auto profiles = collect_stream(result, "profiles.nc", "profile_", profiles_every))
    streams.push_back(std::move(*profiles));
  // What an earlier collection left would be taken for that of the tables beside it.
  if (request.draw || !has_series) remove_pictures(result);
  if (streams.empty()) {
    fs::remove(result.directory / "ensemble.nc");
  } else {
    write_file(request, result, streams);
    made += ", ensemble.nc";
  }
  if (request.draw && has_series) {
    draw_spread(result, streams.front(), out);
    made += " and the pictures";
  }
  out << fmt::format("{}: {}\n", result.directory.string(), made);
  name_former_members(result, out);
}

}  // namespace pileus::study

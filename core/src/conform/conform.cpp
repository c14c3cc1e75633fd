#include "conform/conform.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/parallel.hpp"
#include "conform/check.hpp"
#include "conform/child_process.hpp"
#include "conform/library_checks.hpp"
#include "conform/subject.hpp"
#include "conform/world.hpp"

namespace pileus::conform {
namespace {

using Json = nlohmann::json;

const char* title_of(const std::string& id) {
  for (const Check& check : all_checks())
    if (id == check.id) return check.title;
  return "";
}

bool is_wanted(const Request& request, const std::string& id) {
  return request.only.empty() ||
         std::find(request.only.begin(), request.only.end(), id) != request.only.end();
}

void check_names(const std::vector<std::string>& only) {
  std::vector<std::string> known;
  for (const Check& check : all_checks()) known.emplace_back(check.id);
  for (const std::string& id : only) {
    if (std::find(known.begin(), known.end(), id) != known.end()) continue;
    const std::string nearest = nearest_word(id, known);
    throw Error(ExitCode::usage,
                fmt::format("there is no check '{}'; there are C01 to C27{}", id,
                            nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
}

/// JSON of texts from anywhere: what is no UTF-8 is replaced.
std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json to_json(const LibraryFindings& findings) {
  Json json{{"operators", findings.operators}, {"complaints", Json::array()}};
  for (const auto& complaint : findings.complaints)
    json["complaints"].push_back(
        {{"check", complaint.check}, {"text", complaint.text}, {"fatal", complaint.fatal}});
  return json;
}

/// Looks at the library in a process of its own; one that does not survive it has a complaint.
template <class Examine>
LibraryFindings examine(const Request& request, const char* check, Examine&& look) {
  const ChildResult child =
      run_in_child([&] { return dump(to_json(look(request.library))); }, request.time_limit);
  LibraryFindings findings;
  if (!child.finished) {
    findings.complaints.push_back({check, "loading it " + child.end, true});
    return findings;
  }
  const Json json = Json::parse(child.text);
  findings.operators = json["operators"].get<std::vector<std::string>>();
  for (const Json& entry : json["complaints"])
    findings.complaints.push_back({entry["check"], entry["text"], entry["fatal"]});
  return findings;
}

/// In the child: one check of one operator.
Json look_at(const Request& request, const Check& check, const std::string& id) {
  omp_set_num_threads(1);
  Case c;
  auto library = std::make_shared<host::Library>(host::load_library(request.library));
  for (const host::OperatorTable& table : library->operators)
    if (id == table.op.id) c.table = std::make_shared<const host::OperatorTable>(table);
  c.library = library;
  c.seed = request.seed;
  try {
    return {{"verdict", "passed"}, {"text", check.run(c)}};
  } catch (const Finding& finding) {
    return {{"verdict", "failed"},
            {"text", finding.text},
            {"seed", finding.seed},
            {"parcel", finding.uid}};
  } catch (const NotApplicable& nothing) {
    return {{"verdict", "not applicable"}, {"text", nothing.why}};
  } catch (const StateRefused& refused) {
    return {{"verdict", "failed"}, {"text", "it does not take a random state: " + refused.why}};
  } catch (const Subject::Refused& refused) {
    return {{"verdict", "failed"}, {"text", refused.phase + " " + refused.outcome.describe()}};
  }
}

Verdict verdict_of(const std::string& word) {
  return word == "passed"   ? Verdict::passed
         : word == "failed" ? Verdict::failed
                            : Verdict::not_applicable;
}

Result run_check(const Request& request, const Check& check, const std::string& id) {
  Result result{check.id, check.title, id, Verdict::failed, "", 0, 0};
  const ChildResult child =
      run_in_child([&] { return dump(look_at(request, check, id)); }, request.time_limit);
  if (!child.finished) {
    result.text = "it " + child.end;
    return result;
  }
  const Json json = Json::parse(child.text);
  result.verdict = verdict_of(json["verdict"]);
  result.text = json["text"];
  result.seed = json.value("seed", std::uint64_t{0});
  result.uid = json.value("parcel", std::uint64_t{0});
  return result;
}

/// C07, of the library: the same declarations in two processes.
Result compare_declarations(const Request& request) {
  Result result{"C07", title_of("C07"), "", Verdict::passed, "", 0, 0};
  std::vector<std::string> said;
  for (int process = 0; process < 2; ++process) {
    const ChildResult child =
        run_in_child([&] { return declarations_of(request.library); }, request.time_limit);
    if (!child.finished) {
      result.verdict = Verdict::failed;
      result.text = "loading it " + child.end;
      return result;
    }
    said.push_back(child.text);
  }
  if (said[0] == said[1]) return result;
  const auto at = static_cast<std::size_t>(
      std::mismatch(said[0].begin(), said[0].end(), said[1].begin(), said[1].end()).first -
      said[0].begin());
  const std::size_t line = said[0].rfind('\n', at) + 1;
  result.verdict = Verdict::failed;
  result.text = fmt::format("two processes are told different things, the first time at: {}",
                            said[0].substr(line, said[0].find('\n', line) - line));
  return result;
}

/// Whether a check of the file alone could be made of a library that is refused.
bool could_be_made(const std::string& check, const LibraryFindings& file) {
  return (check == "C01" || check == "C02") && file.complaints.empty();
}

void add_library_results(const Request& request, const LibraryFindings& file,
                         const LibraryFindings& tables, Report& report) {
  for (const Check& check : all_checks()) {
    const std::string id = check.id;
    if (!is_wanted(request, id)) continue;
    Result result{id, check.title, "", Verdict::passed, "", 0, 0};
    for (const auto* findings : {&file, &tables})
      for (const auto& complaint : findings->complaints) {
        if (complaint.check != id) continue;
        result.verdict = Verdict::failed;
        result.text += (result.text.empty() ? "" : "; ") + complaint.text;
      }
    const bool loads = !tables.operators.empty();
    if (result.verdict == Verdict::passed && loads && id == "C07")
      result = compare_declarations(request);
    if (result.verdict == Verdict::passed && !loads && !could_be_made(id, file)) {
      result.verdict = Verdict::not_applicable;
      result.text = "the library is refused";
    }
    // What is checked of every operator is said there.
    if (loads && check.run != nullptr && result.verdict == Verdict::passed) continue;
    report.results.push_back(result);
  }
}

}  // namespace

std::size_t Report::count(Verdict verdict) const {
  return static_cast<std::size_t>(
      std::count_if(results.begin(), results.end(),
                    [&](const Result& result) { return result.verdict == verdict; }));
}

Report conform(const Request& request) {
  check_names(request.only);
  Report report;
  report.library = request.library.string();
  const LibraryFindings file = examine(request, "C01", examine_file);
  LibraryFindings tables;
  const bool readable = std::none_of(file.complaints.begin(), file.complaints.end(),
                                     [](const auto& complaint) { return complaint.fatal; });
  if (readable) tables = examine(request, "C03", examine_tables);
  add_library_results(request, file, tables, report);
  for (const std::string& id : tables.operators)
    for (const Check& check : all_checks())
      if (check.run != nullptr && is_wanted(request, check.id))
        report.results.push_back(run_check(request, check, id));
  return report;
}

}  // namespace pileus::conform

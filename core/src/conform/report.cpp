// The result of the checks, for people and for programs.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "conform/conform.hpp"

namespace pileus::conform {
namespace {

const char* word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return "passed";
    case Verdict::failed:
      return "failed";
    default:
      return "not applicable";
  }
}

/// Where a failure can be seen again.
std::string trace_of(const Result& result) {
  std::string trace;
  if (result.seed != 0) trace += fmt::format("seed {}", result.seed);
  if (result.uid != 0) trace += fmt::format("{}parcel {}", trace.empty() ? "" : ", ", result.uid);
  return trace.empty() ? "" : " (" + trace + ")";
}

}  // namespace

std::string render(const Report& report) {
  std::string text = report.library + "\n";
  std::string heading = "?";
  for (const Result& result : report.results) {
    if (result.operator_id != heading) {
      heading = result.operator_id;
      text += "\n" + (heading.empty() ? std::string("library") : heading) + "\n";
    }
    const std::string reason = result.text + trace_of(result);
    text += fmt::format("  {}  {:<44}  {}{}\n", result.check, result.title, word_of(result.verdict),
                        reason.empty() ? "" : ": " + reason);
  }
  return text + fmt::format("\n{} passed, {} failed, {} not applicable\n",
                            report.count(Verdict::passed), report.count(Verdict::failed),
                            report.count(Verdict::not_applicable));
}

std::string render_json(const Report& report, const Request& request) {
  nlohmann::ordered_json json{{"library", report.library},
                              {"seed", request.seed},
                              {"passed", report.count(Verdict::failed) == 0},
                              {"checks", nlohmann::ordered_json::array()}};
  for (const Result& result : report.results) {
    nlohmann::ordered_json entry{{"check", result.check},
                                 {"title", result.title},
                                 {"operator", result.operator_id},
                                 {"verdict", word_of(result.verdict)},
                                 {"text", result.text}};
    if (result.seed != 0) entry["seed"] = result.seed;
    if (result.uid != 0) entry["parcel"] = result.uid;
    json["checks"].push_back(entry);
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace pileus::conform

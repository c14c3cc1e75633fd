// pileus conform LIB: whether a plugin keeps its promises.
#include "conform/conform.hpp"

#include <iostream>
#include <memory>
#include <string>

#include "host/search.hpp"
#include "number_check.hpp"
#include "verb.hpp"

namespace pileus::cli {
namespace {

/// What is no library at all is a mistake of the command line.
std::filesystem::path find(const std::string& library) {
  try {
    return host::find_library(library, host::default_search_path("."));
  } catch (const Error& error) {
    if (std::filesystem::is_regular_file(library)) return library;
    throw Error(ExitCode::usage, error.what());
  }
}

}  // namespace

void add_conform(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "conform", "Check that a plugin keeps the rules; exit code 3 when it breaks one");
  auto request = std::make_shared<conform::Request>();
  auto library = std::make_shared<std::string>();
  auto as_json = std::make_shared<bool>(false);
  verb->add_option("library", *library, "Path of the library, or the id of an operator in it")
      ->required()
      ->type_name("LIB");
  verb->add_flag("--json", *as_json, "For programs");
  verb->add_option("--only", request->only, "Checks to make, as C05,C13; default: all")
      ->delimiter(',')
      ->type_name("CHECKS");
  verb->add_option("--seed", request->seed, "Of the first random state; default: 1")
      ->check(above_zero())
      ->type_name("N");
  verb->add_option("--time-limit", request->time_limit,
                   "Seconds of processor time for one check; default: 60")
      ->check(above_zero())
      ->type_name("S");
  verb->callback([&action, request, library, as_json] {
    action = [request, library, as_json] {
      request->library = find(*library);
      const conform::Report report = conform::conform(*request);
      std::cout << (*as_json ? conform::render_json(report, *request) : conform::render(report));
      return report.count(conform::Verdict::failed) == 0 ? ExitCode::done : ExitCode::plugin;
    };
  });
}

}  // namespace pileus::cli

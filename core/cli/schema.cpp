// pileus schema: JSON Schemas of scenes, studies and sweeps for editors, and pages for reading.
#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <memory>
#include <string>

#include "authoring/plugin_reference.hpp"
#include "host/search.hpp"
#include "study/declarations.hpp"
#include "study/study_file.hpp"
#include "study/sweep_file.hpp"
#include "verb.hpp"

namespace pileus::cli {

namespace {

struct SchemaRequest {
  std::string kind = "scene";
  bool as_reference = false;
  std::string path;  // empty: standard output
};

std::string text_of(const SchemaRequest& request) {
  const host::SearchPath search = host::default_search_path(".");
  if (request.kind == "plugin") {
    if (!request.as_reference) {
      throw Error(ExitCode::usage,
                  "plugins are not described by a JSON Schema; ask for --reference, their page");
    }
    return authoring::plugin_reference(search);
  }
  const std::string schema = request.kind == "study"   ? study::study_schema()
                             : request.kind == "sweep" ? study::sweep_schema()
                                                       : study::scene_schema(search);
  return request.as_reference ? study::key_reference(request.kind, schema) : schema;
}

ExitCode show(const SchemaRequest& request) {
  const std::string text = text_of(request);
  if (request.path.empty()) {
    std::cout << text;
    return ExitCode::done;
  }
  std::ofstream file(request.path, std::ios::binary);
  file << text;
  if (!file.flush()) {
    throw Error(ExitCode::file, fmt::format("{}: cannot be written", request.path));
  }
  return ExitCode::done;
}

}  // namespace

void add_schema(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("schema",
                                      "Print the JSON Schema of scenes, with the plugins found, or "
                                      "of studies or sweeps, for editors");
  auto request = std::make_shared<SchemaRequest>();
  verb->add_option("kind", request->kind, "scene, study, sweep or plugin; default: scene")
      ->check(CLI::IsMember({"scene", "study", "sweep", "plugin"}))
      ->type_name("KIND");
  verb->add_flag("--reference", request->as_reference, "As a page of Markdown for reading");
  verb->add_option("--write", request->path, "Write to this file instead")->type_name("FILE");
  verb->callback([&action, request] { action = [request] { return show(*request); }; });
}

}  // namespace pileus::cli

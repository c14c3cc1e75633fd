// pileus run SCENE: simulates a scene.
#include <iostream>
#include <memory>

#include "base/terminal.hpp"
#include "model/run.hpp"
#include "output/summary.hpp"
#include "study/target_error.hpp"
#include "verb.hpp"

namespace pileus::cli {

namespace {

ExitCode run(const model::RunRequest& request) {
  std::unique_ptr<Progress> progress = std::make_unique<SilentProgress>();
  if (!request.quiet) {
    progress = std::make_unique<TerminalProgress>(
        std::cerr, TerminalProgress::Options{.interactive = standard_error_is_terminal(),
                                             .width = terminal_width()});
  }
  const model::RunResult result = model::run(request, *progress);
  if (!request.quiet) std::cout << output::print_ledger(result.summary);
  return result.summary.status == output::Summary::Status::stopped ? ExitCode::stopped
                                                                   : ExitCode::done;
}

/// Puts the cheapest setting that meets the target in front of the user's own.
void apply_target(study::TargetRequest& target, model::RunRequest& request) {
  target.scene_path = request.scene_path;
  target.overrides = request.overrides;
  const study::Choice choice = study::choose_setting(target);
  request.overrides.insert(request.overrides.begin(), choice.overrides.begin(),
                           choice.overrides.end());
  if (!request.quiet) std::cout << choice.explanation << std::flush;
}

}  // namespace

void add_run(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("run", "Simulate a scene");
  auto request = std::make_shared<model::RunRequest>();
  verb->add_option("scene", request->scene_path, "YAML file of the scene")
      ->required()
      ->type_name("SCENE");
  verb->add_option("--set", request->overrides,
                   "Replace a value of the scene, e.g. --set time.end='20 min'; repeatable")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  verb->add_option("--out", request->output_directory,
                   "Folder for the results; default: as the scene says, else results/<scene>")
      ->type_name("DIR");
  verb->add_option("--threads", request->threads, "Threads to use; default: one per core")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  auto* resume = verb->add_flag("--resume", request->resume,
                                "Continue from the last checkpoint in the results folder");
  verb->add_flag("--force", request->force, "Replace an earlier run in the results folder")
      ->excludes(resume);
  verb->add_flag("--quiet", request->quiet, "Print errors only");
  auto target = std::make_shared<study::TargetRequest>();
  auto* error = verb->add_option("--target-error", target->target,
                                 "Take the cheapest setting whose measured error is at most this, "
                                 "such as 1%; needs --norm")
                    ->type_name("ERROR");
  auto* norm = verb->add_option("--norm", target->norm, "Name of the error, as its study calls it")
                   ->type_name("NAME")
                   ->needs(error);
  error->needs(norm);
  verb->add_option("--study", target->study,
                   "The findings to choose from, a study.json; default: those kept in a folder "
                   "studies/results above the scene")
      ->type_name("FILE")
      ->needs(error);
  verb->callback([&action, request, target] {
    action = [request, target] {
      if (!target->target.empty()) apply_target(*target, *request);
      return run(*request);
    };
  });
}

}  // namespace pileus::cli

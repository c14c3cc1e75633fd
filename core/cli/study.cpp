// pileus study STUDY: what accuracy costs in time.
#include <iostream>
#include <memory>

#include "base/terminal.hpp"
#include "study/run_study.hpp"
#include "verb.hpp"

namespace pileus::cli {

void add_study(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "study", "Measure what accuracy costs in time: a table, work-precision pictures, files");
  auto request = std::make_shared<study::StudyRequest>();
  auto quiet = std::make_shared<bool>(false);
  verb->add_option("study", request->path, "YAML file of the study")
      ->required()
      ->type_name("STUDY");
  verb->add_option(
          "--out", request->directory,
          "Folder for the results; default: results/studies/<name>. Runs that are finished "
          "there are not made again")
      ->type_name("DIR");
  verb->add_flag("--force", request->force, "Make every run again");
  verb->add_flag("--keep", request->keep,
                 "Keep the findings in results/ beside the study, for 'pileus run --target-error'");
  verb->add_option("--pictures", request->pictures, "Copy the pictures to this folder as well")
      ->type_name("DIR");
  auto no_pictures = std::make_shared<bool>(false);
  verb->add_flag("--no-pictures", *no_pictures, "Draw nothing");
  verb->add_flag("--quiet", *quiet, "No progress, only the table");
  verb->callback([&action, request, quiet, no_pictures] {
    action = [request, quiet, no_pictures] {
      request->draw = !*no_pictures;
      const study::StudyProgress::Options progress{
          .quiet = *quiet, .interactive = standard_error_is_terminal(), .width = terminal_width()};
      return study::run_study(*request, progress, std::cerr, std::cout).code();
    };
  });
}

}  // namespace pileus::cli

// pileus check SCENE…: runs scenes and judges what they expect.
#include "study/check.hpp"

#include <iostream>
#include <memory>

#include "base/terminal.hpp"
#include "verb.hpp"

namespace pileus::cli {

void add_check(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "check", "Run scenes and judge their 'expect' sections; exit code 4 when a bound is missed");
  auto request = std::make_shared<study::CheckRequest>();
  auto quiet = std::make_shared<bool>(false);
  verb->add_option("scenes", request->paths,
                   "YAML files, or folders: of a folder NAME its NAME_small.yaml, else NAME.yaml, "
                   "else every YAML file in it")
      ->required()
      ->type_name("SCENE");
  verb->add_option("--set", request->overrides, "Replace a value in every scene; repeatable")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  verb->add_option("--out", request->results_directory,
                   "Folder for the results; default: a temporary one, kept when a check fails")
      ->type_name("DIR");
  verb->add_option("--threads", request->threads, "Threads to use; default: one per core")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  verb->add_flag("--all", request->all_bounds,
                 "List every bound of every scene, also for folders of several scenes");
  verb->add_flag("--quiet", *quiet, "No progress, only the verdicts");
  verb->callback([&action, request, quiet] {
    action = [request, quiet] {
      SilentProgress silent;
      TerminalProgress shown(std::cerr, {.interactive = true, .width = terminal_width()});
      // Without a terminal the verdicts are progress enough.
      const bool show = !*quiet && standard_error_is_terminal();
      Progress& progress = show ? static_cast<Progress&>(shown) : silent;
      return study::check(*request, progress, std::cout).code();
    };
  });
}

}  // namespace pileus::cli

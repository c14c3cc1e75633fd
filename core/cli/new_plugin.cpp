// pileus new-plugin NAME: a project to begin with.
#include "authoring/new_plugin.hpp"

#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "base/shell_word.hpp"
#include "verb.hpp"

namespace pileus::cli {

void add_new_plugin(CLI::App& app, Action& action) {
  CLI::App* verb =
      app.add_subcommand("new-plugin", "Write the project of a new plugin, complete with tests");
  auto request = std::make_shared<authoring::NewPlugin>();
  verb->add_option("name", request->name, "Of the plugin, in lower case: warm_rain")
      ->required()
      ->type_name("NAME");
  verb->add_option("--kind", request->kind,
                   fmt::format("What it is: {}", fmt::join(authoring::plugin_kinds(), ", ")))
      ->required()
      ->type_name("KIND");
  verb->add_option("--out", request->folder, "Folder to make; default: NAME")->type_name("DIR");
  verb->callback([&action, request] {
    action = [request] {
      const auto files = authoring::write_project(*request);
      const std::string folder = files.front().parent_path().string();
      for (const auto& file : files) std::cout << file.string() << '\n';
      std::cout << fmt::format(
          "\nBuild and test it: cmake -S {0} -B {1} && cmake --build {1} && ctest --test-dir {1}\n"
          "{2}/README.md says more.\n",
          shell_word(folder), shell_word(folder + "/build"), folder);
      return ExitCode::done;
    };
  });
}

}  // namespace pileus::cli

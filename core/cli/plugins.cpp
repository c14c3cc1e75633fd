// pileus plugins: what is on the search path.
#include <iostream>
#include <memory>

#include "host/describe.hpp"
#include "verb.hpp"

namespace pileus::cli {

void add_plugins(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "plugins", "List the plugins that scenes can use; PILEUS_PLUGIN_PATH adds folders");
  auto as_json = std::make_shared<bool>(false);
  verb->add_flag("--json", *as_json, "For programs");
  verb->callback([&action, as_json] {
    action = [as_json] {
      const host::SearchPath search = host::default_search_path(".");
      std::cout << (*as_json ? host::describe_candidates_json(search)
                             : host::describe_candidates(search));
      return ExitCode::done;
    };
  });
}

}  // namespace pileus::cli

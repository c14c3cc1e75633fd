// pileus inspect LIB: what a plugin declares.
#include <iostream>
#include <memory>
#include <string>

#include "host/describe.hpp"
#include "host/library.hpp"
#include "host/search.hpp"
#include "verb.hpp"

namespace pileus::cli {

void add_inspect(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("inspect", "Show everything that a plugin declares");
  auto library = std::make_shared<std::string>();
  auto as_json = std::make_shared<bool>(false);
  verb->add_option("library", *library, "Path of the library, or the id of an operator in it")
      ->required()
      ->type_name("LIB");
  verb->add_flag("--json", *as_json, "For programs");
  verb->callback([&action, library, as_json] {
    action = [library, as_json] {
      const host::Library loaded =
          host::load_library(host::find_library(*library, host::default_search_path(".")));
      std::cout << (*as_json ? host::describe_json(loaded) : host::describe_text(loaded));
      return ExitCode::done;
    };
  });
}

}  // namespace pileus::cli

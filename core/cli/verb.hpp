// How a verb of the command line is declared: it adds its subcommand, and its action when chosen.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>

#include "base/error.hpp"

namespace pileus::cli {

/// What the chosen verb does; set while the command line is parsed, called once afterwards.
using Action = std::function<ExitCode()>;

void add_run(CLI::App& app, Action& action);
void add_plan(CLI::App& app, Action& action);
void add_check(CLI::App& app, Action& action);
void add_plugins(CLI::App& app, Action& action);
void add_inspect(CLI::App& app, Action& action);
void add_conform(CLI::App& app, Action& action);
void add_schema(CLI::App& app, Action& action);
void add_report(CLI::App& app, Action& action);
void add_new_plugin(CLI::App& app, Action& action);
void add_study(CLI::App& app, Action& action);
void add_sweep(CLI::App& app, Action& action);

}  // namespace pileus::cli

// The program: parses the command line, runs one verb and turns its failure into an exit code.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/version.hpp"
#include "host/breadcrumb.hpp"
#include "verb.hpp"

namespace pileus::cli {

namespace {

/// Exit code of what is neither the user's nor the machine's doing.
constexpr int fault_of_ours = 1;

std::string version_text() {
  const BuildRecord& build = build_record();
  std::string text = fmt::format("Pileus {}\ncommit    {}\ncompiler  {}, {}{}{}\nlibraries ",
                                 build.version, build.commit, build.compiler, build.build_type,
                                 build.sanitizer.empty() ? "" : ", sanitizer ", build.sanitizer);
  for (const LibraryVersion& library : build.libraries) {
    text += fmt::format(" {} {}{}", library.name, library.version,
                        &library == &build.libraries.back() ? "" : ",");
  }
  return text;
}

std::vector<std::string> verb_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_word(word, candidates);
  return nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest);
}

[[noreturn]] void refuse(const std::string& sentence, const CLI::App& app) {
  throw Error(ExitCode::usage,
              fmt::format("{}\nSee: {} --help", sentence,
                          app.get_parent() ? "pileus " + app.get_name() : "pileus"));
}

/// A verb the program does not have; CLI11 would only call it an unexpected argument.
void check_verb(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  const std::string word = argv[1];
  const std::vector<std::string> names = verb_names(app);
  for (const std::string& name : names) {
    if (name == word) return;
  }
  refuse(fmt::format("unknown verb '{}'{}", word, suggestion(word, names)), app);
}

/// Arguments CLI11 could not place.
[[noreturn]] void refuse_extras(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const CLI::App& verb = chosen.empty() ? app : *chosen.front();
  const std::vector<std::string> extras = app.remaining(true);
  if (extras.empty()) refuse(error.what(), verb);
  const std::string& word = extras.front();
  if (word.starts_with('-')) {
    const std::string name = word.substr(0, word.find('='));
    refuse(fmt::format("unknown option '{}'{}", name, suggestion(name, option_names(verb))), verb);
  }
  refuse(fmt::format("unexpected argument '{}'", word), verb);
}

int run(int argc, char** argv) {
  CLI::App app(
      "Pileus: a cloud model of elliptical parcels in cells, with plugins for its physics.",
      "pileus");
  app.set_version_flag("--version", version_text());
  app.set_help_flag("-h,--help", "Show this text and leave");
  app.footer(
      "pileus VERB --help tells more about a verb. The launcher in the source tree adds one more:\n"
      "./pileus test builds and runs every test.\n"
      "Exit codes: 0 done, 2 scene or command line wrong, 3 plugin refused or failed,\n"
      "4 numerical failure or a missed expectation, 5 file or disk, 75 stopped on request, resume "
      "me.");
  Action action;
  add_run(app, action);
  add_plan(app, action);
  add_check(app, action);
  add_study(app, action);
  add_sweep(app, action);
  add_report(app, action);
  add_plugins(app, action);
  add_inspect(app, action);
  add_conform(app, action);
  add_new_plugin(app, action);
  add_schema(app, action);
  app.require_subcommand(0, 1);
  check_verb(app, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ExtrasError& error) {
    refuse_extras(app, error);
  } catch (const CLI::Success& success) {  // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    refuse(error.what(), chosen.empty() ? app : *chosen.front());
  }
  if (!action) {
    std::cout << app.help();
    return static_cast<int>(ExitCode::done);
  }
  return static_cast<int>(action());
}

/// Messages of several lines keep their own layout; the program's name stands before the first.
int fail(int code, const std::string& message) {
  fmt::print(stderr, "pileus: {}\n", message);
  return code;
}

}  // namespace

}  // namespace pileus::cli

int main(int argc, char** argv) {
  using pileus::ExitCode;
  pileus::host::install_crash_handler();  // so that a plugin that crashes is named
  try {
    return pileus::cli::run(argc, argv);
  } catch (const pileus::Error& error) {
    return pileus::cli::fail(static_cast<int>(error.code()), error.what());
  } catch (const std::bad_alloc&) {
    return pileus::cli::fail(static_cast<int>(ExitCode::usage),
                             "the scene needs more memory than there is; a coarser mesh or fewer "
                             "parcels per cell need less");
  } catch (const std::exception& error) {
    return pileus::cli::fail(
        pileus::cli::fault_of_ours,
        std::string("this should not happen, please report it: ") + error.what());
  }
}

// pileus sweep SWEEP: one scene with many settings, run as an ensemble.
#include <iostream>
#include <memory>

#include "base/terminal.hpp"
#include "number_check.hpp"
#include "study/sweep_run.hpp"
#include "study/sweep_slurm.hpp"
#include "verb.hpp"

namespace pileus::cli {

namespace {

struct SweepOptions {
  study::SweepRequest request;
  std::size_t member = 0;
  bool quiet = false, no_pictures = false, resume = true, slurm = false, no_submit = false;
};

ExitCode sweep(const SweepOptions& options) {
  if (options.slurm) {
    study::hand_to_slurm(options.request, !options.no_submit, std::cout);
    return ExitCode::done;
  }
  const study::SweepProgress::Options progress{.quiet = options.quiet,
                                               .interactive = standard_error_is_terminal(),
                                               .width = terminal_width()};
  return study::run_sweep(options.request, progress, std::cerr, std::cout).code();
}

void add_ways_to_run(CLI::App& verb, SweepOptions& options) {
  verb.add_option("--jobs", options.request.jobs,
                  "Members that run at a time; default: cores over threads of a member")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  verb.add_option("--threads", options.request.threads,
                  "Threads of every member; default: as the sweep says, else 1")
      ->check(CLI::Range(1, 1024))
      ->type_name("T");
  verb.add_flag("--resume", options.resume,
                "Skip members that are done and continue those that were interrupted; this is "
                "what happens without it, too");
  verb.add_flag("--retry", options.request.retry,
                "Run members again that broke down, from their start");
  verb.add_flag("--force", options.request.force, "Run every member again, from its start");
}

}  // namespace

void add_sweep(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "sweep", "Run a scene with many settings and seeds, and collect the ensemble");
  auto options = std::make_shared<SweepOptions>();
  verb->add_option("sweep", options->request.path, "YAML file of the sweep")
      ->required()
      ->type_name("SWEEP");
  verb->add_option("--out", options->request.directory,
                   "Folder for the results; default: results/sweeps/<name>")
      ->type_name("DIR");
  add_ways_to_run(*verb, *options);
  auto* member = verb->add_option("--member", options->member,
                                  "Run this member only and collect nothing; they count from 0")
                     ->check(not_negative())
                     ->type_name("INDEX");
  auto* collect = verb->add_flag("--collect", options->request.collect_only,
                                 "Run nothing; collect the members that are done");
  verb->add_flag("--copy", options->request.copy,
                 "Copy the members' series into ensemble.nc, which then stands by itself");
  auto* slurm = verb->add_flag("--slurm", options->slurm,
                               "Write a job array for Slurm, one task a member, and submit it");
  verb->add_flag("--no-submit", options->no_submit, "Only write it")->needs(slurm);
  member->excludes(collect)->excludes(slurm);
  collect->excludes(slurm);
  verb->add_flag("--no-pictures", options->no_pictures, "Draw nothing");
  verb->add_flag("--quiet", options->quiet, "No progress, only what came out");
  verb->callback([&action, options, member] {
    if (member->count() > 0) options->request.member = options->member;
    options->request.draw = !options->no_pictures;
    action = [options] { return sweep(*options); };
  });
}

}  // namespace pileus::cli

#include "study/sweep_slurm.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "base/shell_word.hpp"
#include "output/posix_file.hpp"
#include "study/member_results.hpp"
#include "study/scene_settings.hpp"
#include "study/sweep_files.hpp"
#include "study/sweep_identity.hpp"

namespace pileus::study {

namespace fs = std::filesystem;

namespace {

/// Text that stays on its line.
std::string one_line(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

/// A value of an #SBATCH line.
std::string option_word(const std::string& text) {
  return text.find(' ') == std::string::npos ? text : '"' + text + '"';
}

bool is_in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string folder;
  for (const char* c = path == nullptr ? "" : path;; ++c) {
    if (*c != ':' && *c != '\0') {
      folder += *c;
      continue;
    }
    if (!folder.empty() && access((folder + "/" + program).c_str(), X_OK) == 0) return true;
    folder.clear();
    if (*c == '\0') return false;
  }
}

/// Runs a command; throws Error(file) with its words when it fails, else returns them.
std::string words_of(const std::string& command) {
  FILE* process = popen((command + " 2>&1").c_str(), "r");
  if (process == nullptr) throw Error(ExitCode::file, command + ": cannot be started");
  std::string words;
  for (int c = std::fgetc(process); c != EOF; c = std::fgetc(process))
    words += static_cast<char>(c);
  while (!words.empty() && words.back() == '\n') words.pop_back();
  if (pclose(process) != 0) throw Error(ExitCode::file, fmt::format("{}: {}", command, words));
  return words;
}

}  // namespace

std::string slurm_script(const Ensemble& ensemble, const SweepRequest& request,
                         const fs::path& program, const fs::path& sweep, const fs::path& folder) {
  const int threads = request.threads > 0 ? request.threads : ensemble.sweep.threads;
  const std::string throttle = request.jobs > 0 ? fmt::format("%{}", request.jobs) : "";
  std::string script = fmt::format(
      "#!/bin/bash\n"
      "# {0}: one task per member. A task that is told to stop writes a checkpoint and\n"
      "# ends with code 75; submitted again, the array continues what is not done.\n"
      "#SBATCH --job-name={1}\n"
      "#SBATCH --array=0-{2}{3}\n"
      "#SBATCH --ntasks=1\n"
      "#SBATCH --cpus-per-task={4}\n"
      "#SBATCH --output={5}\n"
      "#SBATCH --signal=B:USR1@120\n",
      one_line(ensemble.sweep.title), identifier(ensemble.sweep.name), ensemble.members.size() - 1,
      throttle, threads, option_word((folder / "slurm-%A_%a.txt").string()));
  for (const std::string& option : ensemble.sweep.slurm)
    script += "#SBATCH " + one_line(option) + "\n";
  return script +
         fmt::format(
             "\n"
             "# exec: the signal above reaches the program itself.\n"
             "cd {0} || exit 5\n"
             "exec {1} sweep {2} --out {3} \\\n"
             "  --member \"$SLURM_ARRAY_TASK_ID\" --threads \"${{SLURM_CPUS_PER_TASK:-{4}}}\" "
             "--resume{5} --quiet\n",
             shell_word(fs::current_path().string()), shell_word(program.string()),
             shell_word(sweep.string()), shell_word(folder.string()), threads,
             request.retry ? " --retry" : "");
}

void hand_to_slurm(const SweepRequest& request, bool submit, std::ostream& out) {
  SweepResult result;
  result.ensemble = read_ensemble(request.path);
  result.directory = sweep_folder(request, result.ensemble.sweep);
  claim_folder(result.directory, result.ensemble.sweep, request.force);
  std::vector<std::string> problems;
  result.records = load_records(result.directory, result.ensemble, problems);
  for (const std::string& problem : problems) out << problem << '\n';
  write_member_lists(result);
  const fs::path folder = fs::canonical(result.directory);
  const fs::path script = folder / "sweep.sbatch";
  output::replace_file(script,
                       slurm_script(result.ensemble, request, fs::canonical("/proc/self/exe"),
                                    fs::canonical(request.path), folder));
  out << fmt::format("{}: a task for each of {} members\n", script.string(),
                     result.ensemble.members.size());
  const std::string command = "sbatch " + shell_word(script.string());
  if (submit && is_in_path("sbatch"))
    out << words_of(command) << '\n';
  else
    out << fmt::format("{}submit it with: {}\n", submit ? "there is no sbatch here; " : "",
                       command);
  out << fmt::format("when tasks have ended: pileus sweep {} --out {} --collect\n",
                     shell_word(request.path), shell_word(result.directory.string()));
}

}  // namespace pileus::study

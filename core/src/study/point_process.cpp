#include "study/point_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/error.hpp"
#include "base/signals.hpp"

namespace pileus::study {

namespace fs = std::filesystem;

namespace {

constexpr auto polling_interval = std::chrono::milliseconds(20);
constexpr int polls_between_looks = 20;

std::vector<std::string> arguments_of(const ProcessRequest& request) {
  std::vector<std::string> words = {"pileus", "run", request.scene_path};
  for (const std::string& setting : request.overrides) {
    words.emplace_back("--set");
    words.push_back(setting);
  }
  words.insert(words.end(),
               {"--out", request.folder.string(), "--threads", std::to_string(request.threads),
                "--quiet", request.resume ? "--resume" : "--force"});
  return words;
}

/// In the new process: only async-signal-safe calls between fork and exec.
[[noreturn]] void become(char* const* arguments, int log, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);  // a study that is killed leaves no run behind
  if (getppid() != parent) _exit(127);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  execv("/proc/self/exe", arguments);
  _exit(127);
}

double share_of(const fs::path& folder) {
  std::ifstream file(folder / "status.json");
  const auto status = nlohmann::json::parse(file, nullptr, false);
  if (!status.is_object()) return 0;
  const auto number = [&](const char* name) {
    const auto entry = status.find(name);
    return entry != status.end() && entry->is_number() ? entry->get<double>() : 0.0;
  };
  const double end = number("end_s");
  return end > 0 ? number("time_s") / end : 0;
}

std::string last_words(const fs::path& log) {
  std::ifstream file(log);
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  while (!text.empty() && text.back() == '\n') text.pop_back();
  constexpr std::size_t most = 2000;
  return text.size() > most ? "…" + text.substr(text.size() - most) : text;
}

int code_of(int status) {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

/// Waits for the end; passes a stop on, once.
int wait_for(pid_t process, const fs::path& folder, const Watcher& watcher) {
  bool passed_on = false;
  for (int polls = 1;; ++polls) {
    int status = 0;
    const pid_t ended = waitpid(process, &status, WNOHANG);
    if (ended == process) return code_of(status);
    if (ended < 0 && errno != EINTR) return 127;
    if (stop_requested() && !passed_on) {
      kill(process, SIGTERM);
      passed_on = true;
    }
    if (polls % polls_between_looks == 0) watcher(share_of(folder));
    std::this_thread::sleep_for(polling_interval);
  }
}

}  // namespace

ProcessResult run_process(const ProcessRequest& request, const Watcher& watcher) {
  const fs::path log_path =
      request.log.empty() ? fs::path(request.folder.string() + ".log") : request.log;
  const int log = open(log_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (log < 0)
    throw Error(ExitCode::file,
                fmt::format("{}: cannot be written: {}", log_path.string(), std::strerror(errno)));
  std::error_code ignored;
  fs::remove(request.folder / "status.json", ignored);  // an earlier run's would be taken for ours
  std::vector<std::string> words = arguments_of(request);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t process = fork();
  if (process == 0) become(arguments.data(), log, parent);
  const int reason = errno;
  close(log);
  if (process < 0)
    throw Error(ExitCode::file, fmt::format("cannot start a run: {}", std::strerror(reason)));
  ProcessResult result;
  result.code = wait_for(process, request.folder, watcher);
  result.words = last_words(log_path);
  return result;
}

}  // namespace pileus::study

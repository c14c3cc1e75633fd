#include "study/sweep_run.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "base/signals.hpp"
#include "base/terminal.hpp"
#include "output/checkpoint.hpp"
#include "output/posix_file.hpp"
#include "output/run_directory.hpp"
#include "study/member_results.hpp"
#include "study/sweep_collection.hpp"
#include "study/sweep_files.hpp"
#include "study/sweep_identity.hpp"

namespace pileus::study {

namespace fs = std::filesystem;
using Status = MemberRecord::Status;

namespace {

/// Runs members, a few at a time.
class Pool {
 public:
  Pool(const SweepRequest& request, SweepResult& result, SweepProgress& progress,
       const PointRunner& run)
      : request_(request), result_(result), progress_(progress), run_(run) {}

  void run_all(const std::vector<std::size_t>& open, std::size_t jobs) {
    open_ = open;
    std::vector<std::thread> workers;
    for (std::size_t w = 0; w < std::min(jobs, open.size()); ++w)
      workers.emplace_back([this] { work(); });
    for (std::thread& worker : workers) worker.join();
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void work() {
    try {
      for (;;) {
        const std::size_t next = taken_++;
        if (next >= open_.size() || stop_requested() || broken_) return;
        make(open_[next]);
      }
    } catch (...) {  // the disk: members that run are waited for, none is begun
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      broken_ = true;
    }
  }

  /// Whether a member can go on where an earlier call left it.
  bool can_resume(const MemberRecord& record, const fs::path& folder) const {
    const bool from_start =
        request_.force || record.fails_again() ||
        (request_.retry && record.code == static_cast<int>(ExitCode::file));  // damaged, perhaps
    return !from_start && record.status != Status::waiting &&
           !output::list_checkpoints(folder).empty();
  }

  void make(std::size_t index) {
    const Member& member = result_.ensemble.members[index];
    MemberRecord& record = result_.records[index];
    const fs::path folder = member_folder(result_.directory, index);
    fs::create_directories(folder);
    if (const std::string reason = output::reason_in_use(folder); !reason.empty())
      return leave_alone(index, reason);
    ProcessRequest process{result_.ensemble.sweep.scene_path(),
                           member.overrides,
                           folder,
                           request_.threads > 0 ? request_.threads : result_.ensemble.sweep.threads,
                           can_resume(record, folder),
                           member_log(result_.directory, index)};
    if (!process.resume) record.wall = 0;
    record.status = Status::running;
    record.key = member.key;
    output::replace_file(folder / "scene.yaml", member.resolved, false);
    save_record(result_.directory, index, record);
    progress_.begin(member, process.resume);
    const auto started = std::chrono::steady_clock::now();
    const ProcessResult ended =
        run_(process, [&](double share) { progress_.update(member, share); });
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - started;
    record.wall += taken.count();
    conclude(ended, record);
    save_record(result_.directory, index, record);
    if (record.status == Status::done) remove_checkpoints(folder);
    const bool well = record.status == Status::done;
    if (record.status != Status::stopped)
      progress_.end(member, outcome_words(record, taken.count()), well);
  }

  /// What a member that another process runs has, its record and its log are that process's.
  void leave_alone(std::size_t index, const std::string& reason) {
    if (request_.member) throw Error(ExitCode::file, reason);
    const std::lock_guard lock(mutex_);
    result_.in_use.push_back(
        fmt::format("member {} was left alone: {}", index_text(index), reason));
    result_.records[index].status = Status::running;
  }

  static void conclude(const ProcessResult& ended, MemberRecord& record) {
    record.code = ended.code;
    record.words = ended.code == 0 ? "" : ended.words;
    // One that is told to stop before it listens ends by the signal.
    const bool told =
        stop_requested() && (ended.code == 128 + SIGTERM || ended.code == 128 + SIGINT);
    record.status = ended.code == 0                                             ? Status::done
                    : ended.code == static_cast<int>(ExitCode::stopped) || told ? Status::stopped
                                                                                : Status::failed;
  }

  static std::string outcome_words(const MemberRecord& record, double seconds) {
    return record.status == Status::done ? fmt::format("done ({})", format_duration(seconds))
                                         : fmt::format("failed with exit code {}", record.code);
  }

  static void remove_checkpoints(const fs::path& folder) {
    for (const fs::path& checkpoint : output::list_checkpoints(folder)) fs::remove(checkpoint);
  }

  const SweepRequest& request_;
  SweepResult& result_;
  SweepProgress& progress_;
  const PointRunner& run_;
  std::vector<std::size_t> open_;
  std::atomic<std::size_t> taken_{0};
  std::atomic<bool> broken_{false};
  std::mutex mutex_;
  std::exception_ptr failure_;
};

/// The members to run now.
std::vector<std::size_t> open_members(const SweepRequest& request, const SweepResult& result) {
  std::vector<std::size_t> open;
  for (std::size_t m = 0; m < result.records.size(); ++m) {
    const MemberRecord& record = result.records[m];
    if (request.member && *request.member != m) continue;
    const bool ended = record.status == Status::done || (record.fails_again() && !request.retry);
    if (request.force || !ended) open.push_back(m);
  }
  return open;
}

std::size_t jobs_of(const SweepRequest& request, const Sweep& sweep) {
  if (request.jobs > 0) return static_cast<std::size_t>(request.jobs);
  const int threads = request.threads > 0 ? request.threads : sweep.threads;
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  return std::max<std::size_t>(1, cores / static_cast<unsigned>(std::max(1, threads)));
}

void run_members(const SweepRequest& request, SweepResult& result, SweepProgress& progress,
                 const PointRunner& run) {
  const std::vector<std::size_t> open = open_members(request, result);
  std::size_t done = 0, failed = 0;
  for (std::size_t m = 0; m < result.records.size(); ++m) {
    if (std::find(open.begin(), open.end(), m) != open.end()) continue;
    done += result.records[m].status == Status::done ? 1 : 0;
    failed += result.records[m].status == Status::failed ? 1 : 0;
  }
  progress.already_ended(done, failed);
  install_stop_signals();
  Pool(request, result, progress, run).run_all(open, jobs_of(request, result.ensemble.sweep));
  progress.finish();
  result.stopped = stop_requested();
}

/// The last lines a failed member wrote, indented.
std::string quoted_words(const std::string& words) {
  constexpr std::size_t most_lines = 8;
  std::vector<std::string> lines(1);
  for (const char c : words) {
    if (c == '\n')
      lines.emplace_back();
    else
      lines.back() += c;
  }
  std::string text;
  for (std::size_t l = lines.size() > most_lines ? lines.size() - most_lines : 0; l < lines.size();
       ++l)
    text += "    " + lines[l] + "\n";
  return text;
}

void report_failures(const SweepResult& result, std::optional<std::size_t> only,
                     std::ostream& out) {
  bool any_again = false;
  for (std::size_t m = 0; m < result.records.size(); ++m) {
    const MemberRecord& record = result.records[m];
    if (record.status != Status::failed || (only && *only != m)) continue;
    any_again = any_again || record.fails_again();
    out << fmt::format("\nmember {} ({}) failed with exit code {}{}:\n{}", index_text(m),
                       result.ensemble.members[m].label, record.code,
                       record.code > 128 ? fmt::format(" (signal {})", record.code - 128) : "",
                       quoted_words(record.words));
    const fs::path folder = member_folder(result.directory, m);
    if (const fs::path bundle = failure_bundle(folder); !bundle.empty())
      out << "    state: " << bundle.string() << '\n';
    out << "    log: " << member_log(result.directory, m).string() << '\n';
  }
  if (any_again) out << "\n--retry runs members that broke down again, from their start.\n";
}

std::string count_words(const SweepResult& result) {
  std::array<std::size_t, 5> count{};
  for (const MemberRecord& record : result.records)
    ++count[static_cast<std::size_t>(record.status)];
  std::string text = fmt::format("{} of {} members done", count[static_cast<int>(Status::done)],
                                 result.records.size());
  for (const Status status : {Status::failed, Status::stopped, Status::running, Status::waiting})
    if (const std::size_t n = count[static_cast<std::size_t>(status)]; n > 0)
      text += fmt::format(", {} {}", n, word_of(status));
  return text;
}

}  // namespace

ExitCode SweepResult::code() const {
  if (stopped) return ExitCode::stopped;
  int worst = in_use.empty() ? 0 : static_cast<int>(ExitCode::file);
  for (const MemberRecord& record : records)
    if (record.status == Status::failed || record.status == Status::stopped)
      worst = std::max(worst, record.code);
  return static_cast<ExitCode>(worst);
}

Ensemble read_ensemble(const std::string& path, const Scrutiny& scrutiny) {
  scene::Problems problems;
  Ensemble ensemble = lay_out_members(path, problems, scrutiny);
  problems.throw_if_any();
  return ensemble;
}

fs::path sweep_folder(const SweepRequest& request, const Sweep& sweep) {
  return request.directory.empty() ? fs::path("results") / "sweeps" / sweep.name
                                   : fs::path(request.directory);
}

SweepResult run_sweep(const SweepRequest& request, const SweepProgress::Options& options,
                      std::ostream& messages, std::ostream& out, const PointRunner& run) {
  SweepResult result;
  result.ensemble =
      read_ensemble(request.path, {.plans = !request.collect_only, .only = request.member});
  result.directory = sweep_folder(request, result.ensemble.sweep);
  const std::size_t members = result.ensemble.members.size();
  if (request.member && *request.member >= members)
    throw Error(ExitCode::usage, fmt::format("the sweep has the members 0 to {}, not {}",
                                             members - 1, *request.member));
  // Jobs of a batch system and a collection share the folder with whoever runs the sweep.
  std::optional<output::RunDirectory> held;
  if (request.collect_only && !fs::exists(result.directory / "members"))
    throw Error(ExitCode::usage, fmt::format("{}: holds no members of a sweep to collect",
                                             result.directory.string()));
  if (!request.collect_only && !request.member)
    held.emplace(result.directory, output::RunDirectory::Mode::resume);
  claim_folder(result.directory, result.ensemble.sweep, request.force);
  std::vector<std::string> problems;
  result.records = load_records(result.directory, result.ensemble, problems);
  for (const std::string& problem : problems) out << problem << '\n';
  SweepProgress progress(messages, options, request.member ? 1 : members);
  if (request.member) {
    run_members(request, result, progress, run);
    report_failures(result, request.member, out);
    return result;
  }
  if (!request.collect_only) {
    write_member_lists(result);
    run_members(request, result, progress, run);
  }
  write_member_lists(result);
  out << count_words(result) << '\n';
  for (const std::string& reason : result.in_use) out << reason << '\n';
  if (result.stopped) {
    progress.message(fmt::format("stopped; the same command continues the sweep in {}",
                                 result.directory.string()));
    return result;
  }
  collect(request, result, out);
  report_failures(result, {}, out);
  return result;
}

}  // namespace pileus::study

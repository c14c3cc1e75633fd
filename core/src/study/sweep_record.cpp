#include "study/sweep_record.hpp"

#include <signal.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "output/posix_file.hpp"
#include "study/outcome.hpp"

namespace pileus::study {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr std::array<const char*, 5> words = {"waiting", "running", "stopped", "failed", "done"};

fs::path record_path(const fs::path& sweep, std::size_t index) {
  return member_folder(sweep, index) / "member.json";
}

}  // namespace

bool MemberRecord::fails_again() const {
  constexpr std::array<int, 8> of_its_own = {static_cast<int>(ExitCode::usage),
                                             static_cast<int>(ExitCode::plugin),
                                             static_cast<int>(ExitCode::numerical),
                                             128 + SIGSEGV,
                                             128 + SIGBUS,
                                             128 + SIGFPE,
                                             128 + SIGILL,
                                             128 + SIGABRT};
  return status == Status::failed &&
         std::find(of_its_own.begin(), of_its_own.end(), code) != of_its_own.end();
}

const char* word_of(MemberRecord::Status status) {
  return words[static_cast<std::size_t>(status)];
}

fs::path member_folder(const fs::path& sweep, std::size_t index) {
  return sweep / "members" / index_text(index);
}

fs::path member_log(const fs::path& sweep, std::size_t index) {
  return member_folder(sweep, index) / "log.txt";
}

MemberRecord load_record(const fs::path& sweep, const Member& member) {
  std::ifstream file(record_path(sweep, member.index));
  if (!file) return {};
  try {
    const Json json = Json::parse(file);
    MemberRecord record;
    const auto word = std::find(words.begin(), words.end(), json.at("status").get<std::string>());
    if (word == words.end() || json.at("key") != member.key) return {};
    record.status = static_cast<MemberRecord::Status>(word - words.begin());
    record.key = member.key;
    record.code = json.at("code").get<int>();
    record.words = json.at("words").get<std::string>();
    record.wall = json.at("wall_s").get<double>();
    record.date = json.at("date").get<std::string>();
    return record;
  } catch (const Json::exception&) {
    return {};  // damaged: the member is made again
  }
}

void save_record(const fs::path& sweep, std::size_t index, MemberRecord record) {
  const Json json = {{"status", word_of(record.status)},
                     {"key", record.key},
                     {"code", record.code},
                     {"words", record.words},
                     {"wall_s", record.wall},
                     {"date", date_now()}};
  output::replace_file(record_path(sweep, index),
                       json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

fs::path failure_bundle(const fs::path& member_folder) {
  fs::path found;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(member_folder, none)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("failure") && name.ends_with(".h5")) found = std::max(found, entry.path());
  }
  return found;
}

}  // namespace pileus::study

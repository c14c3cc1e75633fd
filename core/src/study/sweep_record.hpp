// What is known of a member between calls: kept in its folder, the marker that it is done.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "study/sweep_members.hpp"

namespace pileus::study {

struct MemberRecord {
  enum class Status {
    waiting,  // not begun, or begun with another scene or program
    running,  // or ended with the sweep that ran it
    stopped,  // on request, with a checkpoint
    failed,
    done,
  };
  Status status = Status::waiting;
  std::string key;    // of the member that was run
  int code = 0;       // as the process ended; 128 + number when a signal ended it
  std::string words;  // the last lines it wrote, of a failure
  double wall = 0;    // s, over all calls
  std::string date;   // of the last change

  /// Whether it would end in the same way again: a mistake, a breakdown or a crash of its own, but
  /// not the disk, nor a signal from outside.
  bool fails_again() const;
};

/// "done", "failed", …
const char* word_of(MemberRecord::Status status);

/// Where a member's results are in the folder of the sweep.
std::filesystem::path member_folder(const std::filesystem::path& sweep, std::size_t index);
/// Where what it writes goes.
std::filesystem::path member_log(const std::filesystem::path& sweep, std::size_t index);

/// What is known of a member; waiting when there is nothing, or of another scene or program.
MemberRecord load_record(const std::filesystem::path& sweep, const Member& member);
/// Replaces the record in the member's folder. Throws Error(file).
void save_record(const std::filesystem::path& sweep, std::size_t index, MemberRecord record);

/// The file with the state in which a member broke down; empty when there is none.
std::filesystem::path failure_bundle(const std::filesystem::path& member_folder);

}  // namespace pileus::study

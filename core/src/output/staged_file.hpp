// A file whose changes happen all at once or not at all, whatever ends the process in between.
//
// New bytes beyond the committed end go to the file, where nobody looks yet; changes of bytes that
// exist are held back in memory. A commit writes those to a redo journal beside the
// file, applies them and removes the journal. A process that dies before the journal is complete
// leaves the old content, one that dies later leaves a journal from which the next opening
// finishes the change. A full disk shows before anything that exists was touched.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "output/posix_file.hpp"

namespace pileus::output {

class StagedFile {
 public:
  enum class Mode {
    create,  // appears under its name at the commit, replacing what was there
    update,  // an existing file; an interrupted commit of an earlier process is finished first
    read,    // sees an interrupted commit as finished
  };

  /// The order in which a commit changes existing pages, so that somebody who reads meanwhile meets
  /// a reference only after what it refers to.
  enum class Role { data, index, header };

  /// Opens; throws Error(ExitCode::file).
  StagedFile(std::filesystem::path path, Mode mode);
  /// Discards what was not committed.
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  Mode mode() const { return mode_; }
  /// Size in bytes as the holder of this object sees it.
  std::uint64_t size() const { return size_; }
  void truncate(std::uint64_t size) { size_ = size; }

  /// Bytes beyond the end read as zero. False with errno set when the system refuses.
  bool read(std::uint64_t offset, std::size_t bytes, void* buffer) const;
  /// Never fails here: the first failure is kept in `failure()`, makes the commit throw, and turns
  /// later writes into no-ops. HDF5 cannot close a file whose driver fails; it can close this one.
  void write(std::uint64_t offset, std::size_t bytes, const void* buffer, Role role = Role::data);
  /// errno of the first failed write, or 0.
  int failure() const { return failure_; }

  /// Makes the changes permanent and closes the file; `durable` syncs file and folder, so that they
  /// survive a power cut. On failure throws Error(ExitCode::file) and leaves the old content.
  void commit(bool durable);
  /// Drops the changes and closes the file.
  void discard() noexcept;

 private:
  static constexpr std::uint64_t page_bytes = 4096;
  /// New pieces from this size on go to the file at once, smaller ones are collected until the
  /// commit: HDF5 writes its metadata in hundreds of bytes.
  static constexpr std::uint64_t direct_bytes = 65536;
  struct Page {
    std::unique_ptr<std::byte[]> content;
    Role role = Role::data;  // the last of those written to it
  };

  std::filesystem::path journal_path() const;
  std::filesystem::path aside_path() const;
  /// The journal of a commit that was decided but not finished, or nothing.
  std::vector<std::byte> interrupted_commit() const;
  void finish_interrupted_commit();
  /// Shows a reader the content the journal leads to, without touching the file.
  void look_through(const std::vector<std::byte>& journal);
  void hold(std::uint64_t offset, std::size_t bytes, const std::byte* from, Role role);
  bool holds_part_of(std::uint64_t begin, std::uint64_t end) const;
  /// Writes the held bytes at and beyond `begin`; false with errno set when the system refuses.
  bool write_held_beyond(std::uint64_t begin) const;
  void commit_new(bool durable);
  void commit_update(bool durable);
  std::vector<std::byte> journal() const;
  void apply(const std::vector<std::byte>& journal);

  std::filesystem::path path_;
  Mode mode_;
  Descriptor file_;
  std::uint64_t committed_ = 0;  // bytes below are held back when written
  std::uint64_t size_ = 0;
  std::map<std::uint64_t, Page> held_;
  int failure_ = 0;
};

}  // namespace pileus::output

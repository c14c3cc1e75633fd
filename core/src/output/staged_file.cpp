#include "output/staged_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/sha256.hpp"

namespace pileus::output {

namespace {

constexpr char journal_magic[8] = {'P', 'I', 'L', 'E', 'U', 'S', 'J', '1'};

/// Journal: this header, then piece_count times {offset, bytes, content}, then the SHA-256 of all
/// that. Native byte order: it lives for milliseconds on one machine.
struct JournalHeader {
  char magic[8];
  std::uint64_t committed_bytes, final_bytes, piece_count;
};
struct PieceHeader {
  std::uint64_t offset, bytes;
};

/// Calls use(offset, bytes, content) for each piece of a complete journal.
template <class Use>
void for_each_piece(const std::vector<std::byte>& journal, Use&& use) {
  JournalHeader header;
  std::memcpy(&header, journal.data(), sizeof header);
  const std::byte* at = journal.data() + sizeof header;
  for (std::uint64_t n = 0; n < header.piece_count; ++n) {
    PieceHeader piece;
    std::memcpy(&piece, at, sizeof piece);
    at += sizeof piece;
    use(piece.offset, piece.bytes, at);
    at += piece.bytes;
  }
}

void append_bytes(std::vector<std::byte>& to, const void* data, std::size_t bytes) {
  const std::size_t before = to.size();
  to.resize(before + bytes);
  std::memcpy(to.data() + before, data, bytes);
}

bool journal_is_complete(const std::string& text) {
  constexpr std::size_t digest_bytes = std::tuple_size_v<Sha256::Digest>;
  if (text.size() < sizeof(JournalHeader) + digest_bytes) return false;
  if (std::memcmp(text.data(), journal_magic, sizeof journal_magic) != 0) return false;
  const std::size_t body = text.size() - digest_bytes;
  const Sha256::Digest digest = Sha256().update(text.data(), body).finish();
  return std::memcmp(digest.data(), text.data() + body, digest_bytes) == 0;
}

std::uint64_t file_size(int descriptor, const std::filesystem::path& path) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) throw file_error(path, "read", errno);
  return static_cast<std::uint64_t>(status.st_size);
}

}  // namespace

std::filesystem::path StagedFile::journal_path() const {
  return path_.string() + ".journal";
}
std::filesystem::path StagedFile::aside_path() const {
  return path_.string() + ".tmp";
}

StagedFile::StagedFile(std::filesystem::path path, Mode mode)
    : path_(std::move(path)), mode_(mode) {
  if (mode_ == Mode::create) {
    file_ = Descriptor(aside_path(), O_RDWR | O_CREAT | O_TRUNC, "create");
    return;
  }
  file_ = Descriptor(path_, mode_ == Mode::update ? O_RDWR : O_RDONLY, "open");
  if (mode_ == Mode::update) finish_interrupted_commit();
  committed_ = size_ = file_size(file_.get(), path_);
  if (mode_ == Mode::read)
    if (const std::vector<std::byte> changes = interrupted_commit(); !changes.empty())
      look_through(changes);
}

StagedFile::~StagedFile() {
  discard();
}

bool StagedFile::read(std::uint64_t offset, std::size_t bytes, void* buffer) const {
  auto* to = static_cast<std::byte*>(buffer);
  const std::int64_t count = read_fully(file_.get(), to, bytes, offset);
  if (count < 0) return false;
  std::memset(to + count, 0, bytes - static_cast<std::size_t>(count));
  const std::uint64_t end = offset + bytes;
  for (auto page = held_.lower_bound(offset / page_bytes);
       page != held_.end() && page->first * page_bytes < end; ++page) {
    const std::uint64_t page_start = page->first * page_bytes;
    const std::uint64_t from = std::max(offset, page_start);
    const std::uint64_t to_end = std::min(end, page_start + page_bytes);
    std::memcpy(to + (from - offset), page->second.content.get() + (from - page_start),
                to_end - from);
  }
  return true;
}

void StagedFile::hold(std::uint64_t offset, std::size_t bytes, const std::byte* from, Role role) {
  const std::uint64_t end = offset + bytes;
  for (std::uint64_t at = offset; at < end && failure_ == 0;) {
    const std::uint64_t index = at / page_bytes, page_start = index * page_bytes;
    const std::uint64_t stop = std::min(end, page_start + page_bytes);
    Page& page = held_[index];
    if (!page.content) {
      page.content = std::make_unique<std::byte[]>(page_bytes);
      const bool whole = stop - at == page_bytes;
      if (!whole && read_fully(file_.get(), page.content.get(), page_bytes, page_start) < 0)
        failure_ = errno;
    }
    page.role = std::max(page.role, role);
    std::memcpy(page.content.get() + (at - page_start), from + (at - offset), stop - at);
    at = stop;
  }
}

void StagedFile::write(std::uint64_t offset, std::size_t bytes, const void* buffer, Role role) {
  if (failure_ != 0 || bytes == 0) return;
  if (!file_ || mode_ == Mode::read) {
    failure_ = EBADF;
    return;
  }
  const std::uint64_t end = offset + bytes;
  size_ = std::max(size_, end);
  if (offset >= committed_ && bytes >= direct_bytes && !holds_part_of(offset, end)) {
    if (!write_fully(file_.get(), buffer, bytes, offset)) failure_ = errno;
    return;
  }
  hold(offset, bytes, static_cast<const std::byte*>(buffer), role);
}

bool StagedFile::holds_part_of(std::uint64_t begin, std::uint64_t end) const {
  const auto page = held_.lower_bound(begin / page_bytes);
  return page != held_.end() && page->first * page_bytes < end;
}

bool StagedFile::write_held_beyond(std::uint64_t begin) const {
  std::vector<std::byte> run;  // neighbouring pages go to the file in one call
  std::uint64_t run_start = begin;
  auto flush = [&] {
    return run.empty() || write_fully(file_.get(), run.data(), run.size(), run_start);
  };
  for (auto page = held_.lower_bound(begin / page_bytes); page != held_.end(); ++page) {
    const std::uint64_t page_start = page->first * page_bytes;
    const std::uint64_t from = std::max(begin, page_start);
    const std::uint64_t stop = std::min(size_, page_start + page_bytes);
    if (from >= stop) continue;
    if (from != run_start + run.size()) {
      if (!flush()) return false;
      run.clear();
      run_start = from;
    }
    append_bytes(run, page->second.content.get() + (from - page_start), stop - from);
  }
  return flush();
}

void StagedFile::commit(bool durable) {
  if (failure_ != 0) {
    const int reason = failure_;
    discard();
    throw file_error(path_, "write", reason);
  }
  try {
    mode_ == Mode::create ? commit_new(durable) : commit_update(durable);
  } catch (...) {
    discard();
    throw;
  }
  held_.clear();
  file_.reset();
}

void StagedFile::commit_new(bool durable) {
  if (!write_held_beyond(0) || ::ftruncate(file_.get(), static_cast<off_t>(size_)) != 0 ||
      (durable && ::fsync(file_.get()) != 0))
    throw file_error(path_, "write", errno);
  // A journal left by an earlier file of this name must not be applied to the new one.
  ::unlink(journal_path().c_str());
  if (::rename(aside_path().c_str(), path_.c_str()) != 0) throw file_error(path_, "create", errno);
  if (durable) sync_directory(path_.parent_path());
}

std::vector<std::byte> StagedFile::journal() const {
  std::vector<std::byte> text;
  text.reserve(sizeof(JournalHeader) + held_.size() * (page_bytes + sizeof(PieceHeader)) + 32);
  JournalHeader header{{}, committed_, size_, 0};
  std::memcpy(header.magic, journal_magic, sizeof journal_magic);
  append_bytes(text, &header, sizeof header);
  const std::uint64_t end = std::min(committed_, size_);
  for (const Role role : {Role::data, Role::index, Role::header}) {
    PieceHeader piece{0, 0};  // neighbouring pages make one piece
    std::size_t piece_at = 0;
    for (const auto& [index, page] : held_) {
      const std::uint64_t start = index * page_bytes;
      if (page.role != role || start >= end) continue;
      if (piece.bytes == 0 || start != piece.offset + piece.bytes) {
        piece = {start, 0};
        piece_at = text.size();
        append_bytes(text, &piece, sizeof piece);
        ++header.piece_count;
      }
      const std::uint64_t bytes = std::min(page_bytes, end - start);
      append_bytes(text, page.content.get(), bytes);
      piece.bytes += bytes;
      std::memcpy(text.data() + piece_at, &piece, sizeof piece);
    }
  }
  std::memcpy(text.data(), &header, sizeof header);
  const Sha256::Digest digest = Sha256().update(text.data(), text.size()).finish();
  append_bytes(text, digest.data(), digest.size());
  return text;
}

void StagedFile::apply(const std::vector<std::byte>& journal) {
  JournalHeader header;
  std::memcpy(&header, journal.data(), sizeof header);
  for_each_piece(journal,
                 [this](std::uint64_t offset, std::size_t bytes, const std::byte* content) {
                   if (!write_fully(file_.get(), content, bytes, offset))
                     throw file_error(path_, "write", errno);
                 });
  if (::ftruncate(file_.get(), static_cast<off_t>(header.final_bytes)) != 0)
    throw file_error(path_, "set the size", errno);
}

void StagedFile::commit_update(bool durable) {
  const std::vector<std::byte> changes = journal();
  const std::filesystem::path beside = journal_path();
  // New bytes have to be in the file before the journal that refers to them.
  if (!write_held_beyond(committed_)) throw file_error(path_, "write", errno);
  if (durable && ::fsync(file_.get()) != 0) throw file_error(path_, "sync", errno);
  {
    const Descriptor file(beside, O_WRONLY | O_CREAT | O_TRUNC, "write");
    if (!write_fully(file.get(), changes.data(), changes.size(), 0) ||
        (durable && ::fsync(file.get()) != 0)) {
      const int reason = errno;
      ::unlink(beside.c_str());
      throw file_error(path_, "write", reason);
    }
  }
  // From here on the change is decided; a failure leaves the journal for the next opening.
  committed_ = std::max(committed_, size_);
  apply(changes);
  if (durable && ::fsync(file_.get()) != 0) throw file_error(path_, "sync", errno);
  ::unlink(beside.c_str());
}

std::vector<std::byte> StagedFile::interrupted_commit() const {
  const std::filesystem::path beside = journal_path();
  if (::access(beside.c_str(), F_OK) != 0) return {};
  const std::string text = read_text_file(beside);
  if (!journal_is_complete(text)) return {};
  JournalHeader header;
  std::memcpy(&header, text.data(), sizeof header);
  // A file shorter than the journal's start is not the one the journal was made for.
  if (file_size(file_.get(), path_) < std::min(header.committed_bytes, header.final_bytes))
    return {};
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

void StagedFile::finish_interrupted_commit() {
  const std::vector<std::byte> changes = interrupted_commit();
  if (!changes.empty()) apply(changes);
  ::unlink(journal_path().c_str());
}

void StagedFile::look_through(const std::vector<std::byte>& journal) {
  JournalHeader header;
  std::memcpy(&header, journal.data(), sizeof header);
  for_each_piece(journal,
                 [this](std::uint64_t offset, std::size_t bytes, const std::byte* content) {
                   hold(offset, bytes, content, Role::data);
                 });
  committed_ = size_ = header.final_bytes;
}

void StagedFile::discard() noexcept {
  if (!file_) return;
  if (mode_ == Mode::create) ::unlink(aside_path().c_str());
  if (mode_ == Mode::update) {
    struct stat status {};
    // Only what this object added goes; a decided commit raised committed_ and keeps its bytes.
    if (::fstat(file_.get(), &status) == 0 &&
        static_cast<std::uint64_t>(status.st_size) > committed_)
      if (::ftruncate(file_.get(), static_cast<off_t>(committed_)) != 0) failure_ = errno;
  }
  held_.clear();
  file_.reset();
}

}  // namespace pileus::output

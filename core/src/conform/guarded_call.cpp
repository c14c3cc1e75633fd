#include "conform/guarded_call.hpp"

#include <fmt/format.h>
#include <setjmp.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <new>

namespace pileus::conform {
namespace {

constexpr unsigned char pattern = 0xA5;

std::size_t page() {
  return static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

// The handler of a forbidden write leaves the call; there is one at a time.
sigjmp_buf leave_call;
const void* volatile forbidden_address = nullptr;

void on_forbidden_write(int, siginfo_t* info, void*) {
  forbidden_address = info->si_addr;
  siglongjmp(leave_call, 1);
}

/// Catches forbidden writes in its scope.
class WriteTrap {
 public:
  WriteTrap() {
    struct sigaction action {};
    action.sa_sigaction = on_forbidden_write;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    ::sigemptyset(&action.sa_mask);
    ::sigaction(SIGSEGV, &action, &before_);
  }
  ~WriteTrap() { ::sigaction(SIGSEGV, &before_, nullptr); }
  WriteTrap(const WriteTrap&) = delete;
  WriteTrap& operator=(const WriteTrap&) = delete;

 private:
  struct sigaction before_ {};
};

/// No object with a destructor lives across the jump.
bool run_trapped(const std::function<void()>& hook) {
  if (sigsetjmp(leave_call, 1) != 0) return false;
  hook();
  return true;
}

using Memory = std::vector<std::unique_ptr<GuardedMemory>>;

std::string describe_write(const Memory& memory, const void* address) {
  for (const auto& piece : memory) {
    if (!piece->holds(address)) continue;
    if (piece->is_inside(address))
      return fmt::format("it wrote to {}, which it may only read", piece->name());
    const auto* at = static_cast<const unsigned char*>(address);
    const auto* data = static_cast<const unsigned char*>(piece->data());
    const auto off = at < data ? at - data : at - (data + piece->bytes());
    return fmt::format("it wrote outside of {}, {} bytes {}", piece->name(), off < 0 ? -off : off,
                       off < 0 ? "before it" : "behind it");
  }
  return "it wrote to memory that is not its own";
}

template <class T>
void guard(Memory& memory, const T*& array, std::size_t count, const char* name) {
  if (array == nullptr) return;
  memory.push_back(std::make_unique<GuardedMemory>(array, count * sizeof(T), name));
  memory.back()->protect();
  array = static_cast<const T*>(memory.back()->data());
}

/// The slot's values in guarded memory; null where there are none, or they are the world's.
GuardedMemory* guard_slot(Memory& memory, Frame& frame, std::size_t s, pileus_view& view,
                          bool writable) {
  FrameSlot& slot = frame.slots()[s];
  const bool of_world = slot.kind == FrameSlot::Kind::item && frame.world().bound().resizes_items;
  if (!slot.exists() || of_world) return nullptr;
  memory.push_back(std::make_unique<GuardedMemory>(
      slot.values.data(), slot.values.size() * sizeof(double), frame.name(s)));
  view.data = memory.back()->data();
  if (!writable) memory.back()->protect();
  return memory.back().get();
}

}  // namespace

GuardedMemory::GuardedMemory(const void* from, std::size_t bytes, std::string name)
    : name_(std::move(name)), bytes_(bytes) {
  const std::size_t inner = std::max<std::size_t>(1, (bytes + page() - 1) / page()) * page();
  length_ = inner + 2 * page();
  void* pages =
      ::mmap(nullptr, length_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (pages == MAP_FAILED) throw std::bad_alloc();
  pages_ = static_cast<unsigned char*>(pages);
  data_ = pages_ + page() + (inner - bytes);
  std::memset(pages_ + page(), pattern, inner - bytes);
  if (bytes > 0) std::memcpy(data_, from, bytes);
  ::mprotect(pages_, page(), PROT_READ);
  ::mprotect(pages_ + page() + inner, page(), PROT_READ);
}

GuardedMemory::~GuardedMemory() {
  ::munmap(pages_, length_);
}

void GuardedMemory::protect() {
  ::mprotect(pages_, length_, PROT_READ);
}

bool GuardedMemory::margin_is_untouched() const {
  return std::all_of(pages_ + page(), data_, [](unsigned char byte) { return byte == pattern; });
}

bool GuardedMemory::holds(const void* address) const {
  const auto* at = static_cast<const unsigned char*>(address);
  return at >= pages_ && at < pages_ + length_;
}

bool GuardedMemory::is_inside(const void* address) const {
  const auto* at = static_cast<const unsigned char*>(address);
  return at >= data_ && at < data_ + bytes_;
}

std::optional<std::string> call_guarded(Frame& frame, Call& call, bool diagnosing,
                                        const std::function<void()>& hook) {
  Memory memory;
  std::vector<GuardedMemory*> written(frame.slots().size(), nullptr);
  for (std::size_t s = 0; s < frame.slots().size(); ++s) {
    const FrameSlot& slot = frame.slots()[s];
    const bool writable = slot.exists() && slot.writable && slot.derived == diagnosing;
    GuardedMemory* piece = guard_slot(memory, frame, s, call.views[s], writable);
    if (writable) written[s] = piece;
  }
  pileus_block& block = call.block;
  const auto count = static_cast<std::size_t>(block.count);
  guard(memory, block.uid, count, "the identities of the parcels");
  guard(memory, block.active, static_cast<std::size_t>(block.active_count), "the list of parcels");
  if (!frame.world().bound().resizes_items) {
    guard(memory, block.item_begin, block.item_begin != nullptr ? count : 0, "item_begin");
    guard(memory, block.item_count, block.item_count != nullptr ? count : 0, "item_count");
  }
  GuardedMemory ledger(call.ledger.data(), (call.ledger.size() - 1) * sizeof(double), "the ledger");
  block.ledger = static_cast<double*>(ledger.data());
  {
    const WriteTrap trap;
    if (!run_trapped(hook)) return describe_write(memory, forbidden_address);
  }
  for (const auto& piece : memory)
    if (!piece->margin_is_untouched()) return fmt::format("it wrote just before {}", piece->name());
  if (!ledger.margin_is_untouched()) return "it wrote just before the ledger";
  for (std::size_t s = 0; s < written.size(); ++s)
    if (written[s] != nullptr)
      std::memcpy(frame.slots()[s].values.data(), written[s]->data(), written[s]->bytes());
  std::memcpy(call.ledger.data(), ledger.data(), ledger.bytes());
  return std::nullopt;
}

}  // namespace pileus::conform

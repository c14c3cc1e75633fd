// What the host lends to plugins: memory that goes back, loops, and their failures.
#include "host/services.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>
#include <set>

#include "base/parallel.hpp"
#include "pileus/plugin.hpp"

namespace pileus::host {
namespace {

class ServicesTest : public testing::Test {
 protected:
  ServicesTest() { release_scratch(); }
  ~ServicesTest() override { omp_set_num_threads(threads_); }
  const pileus_host& host() const { return services_.table(); }
  void* scratch(std::size_t bytes) const { return host().scratch(&host(), bytes); }

 private:
  int threads_ = omp_get_max_threads();
  Services services_{"test", {}};
};

TEST_F(ServicesTest, scratch_memory_is_aligned_and_apart) {
  std::set<char*> begins;
  for (const std::size_t bytes : {1u, 64u, 65u, 70000u, 200000u, 8u}) {
    auto* memory = static_cast<char*>(scratch(bytes));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory) % 64, 0u);
    std::memset(memory, 0x5A, bytes);
    const auto next = begins.upper_bound(memory);
    if (next != begins.end()) {
      EXPECT_LE(memory + bytes, *next);
    }
    begins.insert(memory);
  }
}

/// Chunk after chunk of a loop gets the memory that the one before it gave back; without that, each
/// of the 500 would keep its own.
TEST_F(ServicesTest, scratch_memory_of_a_chunk_goes_back_and_that_of_the_caller_stays) {
  constexpr std::size_t bytes = 4096, chunks = 500;
  omp_set_num_threads(3);
  auto* own = static_cast<unsigned char*>(scratch(bytes));
  std::memset(own, 0xA5, bytes);
  struct Seen {
    const pileus_host& host;
    std::mutex lock;
    std::set<void*> places;
  } seen{host(), {}, {}};
  const auto body = [](void* user, std::int64_t, std::int64_t, pileus_error*) -> pileus_status {
    auto& here = *static_cast<Seen*>(user);
    void* memory = here.host.scratch(&here.host, bytes);
    std::memset(memory, 0, bytes);
    const std::lock_guard guard(here.lock);
    here.places.insert(memory);
    return PILEUS_OK;
  };
  EXPECT_EQ(host().parallel_for(&host(), chunks, 1, body, &seen, nullptr), PILEUS_OK);
  EXPECT_LE(seen.places.size(), 3u);
  EXPECT_EQ(seen.places.count(own), 0u);
  EXPECT_TRUE(std::all_of(own, own + bytes, [](unsigned char byte) { return byte == 0xA5; }));
}

TEST_F(ServicesTest, more_scratch_memory_than_there_can_be_is_none) {
  constexpr std::size_t most = std::numeric_limits<std::size_t>::max();
  for (const std::size_t bytes : {most, most - 63, most / 2 + 1})
    EXPECT_EQ(scratch(bytes), nullptr);
  EXPECT_NE(scratch(64), nullptr);
}

/// 2^61 + 1 doubles are 8 bytes when the size wraps around.
TEST_F(ServicesTest, a_number_of_values_whose_bytes_overflow_is_refused) {
  const pileus_block raw{};
  const Block block(raw, host());
  EXPECT_THROW(block.scratch((std::size_t{1} << 61) + 1), std::bad_alloc);
  EXPECT_EQ(block.scratch(3).size(), 3u);
}

TEST_F(ServicesTest, a_failed_chunk_fails_the_loop_with_its_record) {
  pileus_error error{};
  error.size = sizeof error;
  const auto body = [](void*, std::int64_t begin, std::int64_t,
                       pileus_error* record) -> pileus_status {
    if (begin < 300) return PILEUS_OK;
    record->uid = static_cast<std::uint64_t>(begin);
    return PILEUS_E_DIVERGED;
  };
  EXPECT_EQ(host().parallel_for(&host(), 1000, 100, body, nullptr, &error), PILEUS_E_DIVERGED);
  EXPECT_EQ(error.uid, 300u);
}

/// Records of plugins of another version may be shorter than the core's.
TEST_F(ServicesTest, a_failed_chunk_leaves_alone_what_lies_behind_the_record) {
  pileus_error error{};
  error.size = offsetof(pileus_error, dt_hint);
  error.dt_hint = 7;
  const auto body = [](void*, std::int64_t, std::int64_t, pileus_error* record) {
    record->value = 3;
    record->dt_hint = 5;
    return pileus_status{PILEUS_E_DIVERGED};
  };
  EXPECT_EQ(host().parallel_for(&host(), 10, 10, body, nullptr, &error), PILEUS_E_DIVERGED);
  EXPECT_EQ(error.value, 3);
  EXPECT_EQ(error.dt_hint, 7);
  EXPECT_EQ(error.size, offsetof(pileus_error, dt_hint));
}

TEST_F(ServicesTest, says_whether_the_run_is_to_stop) {
  EXPECT_EQ(host().should_stop(&host()), 0);
  Lent lent;
  lent.stop = [] { return true; };
  const Services asked("test", lent);
  EXPECT_EQ(asked.table().should_stop(&asked.table()), 1);
}

TEST(Block, refuses_what_describe_left_out) {
  const std::array<pileus_view, 1> views{};
  pileus_block raw{};
  raw.views = views.data();
  const Services services("test", {});
  const Block block(raw, services.table());
  EXPECT_THROW(block.has(Slot{}), Failure);
  EXPECT_THROW(block.in(Slot{}), Failure);
  EXPECT_THROW(block.book(Budget{}, 1.0), Failure);
  EXPECT_FALSE(block.has(Slot{0}));
}

}  // namespace
}  // namespace pileus::host

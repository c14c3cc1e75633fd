#include "output/checkpoint.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/error.hpp"
#include "output/failure_bundle.hpp"
#include "output/state_hash.hpp"
#include "sample_store.hpp"
#include "support.hpp"

namespace pileus::output {
namespace {

parcels::Store store_of(std::size_t size, std::uint64_t seed, int dimension = 3) {
  parcels::Store store(dimension, sample_scalars());
  store.resize(size);
  fill_with_bits(store, seed);
  return store;
}

Checkpoint sample_checkpoint(std::uint64_t step) {
  Checkpoint checkpoint{0.1 * static_cast<double>(step), step, 0.1, {}};
  checkpoint.data.arrays["mean_wind"] = {1.0 / 3, -0.0};
  checkpoint.data.arrays["empty"] = {};
  checkpoint.data.counters["seeds"] = {18446744073709551615u, 0};
  checkpoint.data.bytes["operators/two%moment/state"] = {0, 255, 10};
  checkpoint.data.bytes["."] = {1};
  checkpoint.data.texts["scene"] = "name: böe\n\ttab\n";
  checkpoint.data.texts["none"] = "";
  return checkpoint;
}

std::string message_of(const std::filesystem::path& path, parcels::Store& store) {
  try {
    read_checkpoint(path, store);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::file);
    return error.what();
  }
  return {};
}

TEST(Checkpoint, everything_comes_back_bit_for_bit) {
  for (const int dimension : {2, 3})
    for (const std::size_t size : {0, 1, 1000}) {
      const ScratchFolder folder;
      const parcels::Store store = store_of(size, 3, dimension);
      const Checkpoint written = sample_checkpoint(17);
      const auto path = write_checkpoint(folder.path(), store, written, 2);
      EXPECT_EQ(path, folder / "checkpoint_000000000017.h5");
      verify_checkpoint(path);
      parcels::Store back = store_of(5, 4, dimension);
      const Checkpoint read = read_checkpoint(path, back);
      EXPECT_TRUE(same_state(store, back));
      EXPECT_EQ(read.step, 17u);
      EXPECT_EQ(read.time, written.time);
      EXPECT_EQ(read.dt, written.dt);
      EXPECT_EQ(read.data, written.data);
    }
}

TEST(Checkpoint, only_the_newest_are_kept) {
  const ScratchFolder folder;
  const parcels::Store store = store_of(10, 1);
  for (const std::uint64_t step : {1, 5, 9, 12})
    write_checkpoint(folder.path(), store, {0, step, 0, {}}, 2);
  const std::vector<std::filesystem::path> expected = {folder / "checkpoint_000000000012.h5",
                                                       folder / "checkpoint_000000000009.h5"};
  EXPECT_EQ(list_checkpoints(folder.path()), expected);
  // A run resumed from step 5 gives up the steps after it.
  write_checkpoint(folder.path(), store, {0, 7, 0, {}}, 2);
  EXPECT_EQ(list_checkpoints(folder.path()),
            std::vector<std::filesystem::path>{folder / "checkpoint_000000000007.h5"});
}

TEST(Checkpoint, other_files_are_no_checkpoints) {
  const ScratchFolder folder;
  for (const char* name : {"checkpoint_.h5", "checkpoint_12x.h5", "checkpoint_000000000012.h5.tmp",
                           "summary.json", "checkpoint_-1.h5"})
    std::ofstream(folder / name) << "x";
  EXPECT_TRUE(list_checkpoints(folder.path()).empty());
  EXPECT_FALSE(find_newest_valid_checkpoint(folder.path()));
  EXPECT_FALSE(find_newest_valid_checkpoint(folder / "missing"));
}

TEST(Checkpoint, damaged_newest_is_skipped_for_the_one_before) {
  const ScratchFolder folder;
  const parcels::Store store = store_of(100, 1);
  const auto older = write_checkpoint(folder.path(), store, sample_checkpoint(1), 3);
  const auto newer = write_checkpoint(folder.path(), store, sample_checkpoint(2), 3);
  EXPECT_EQ(find_newest_valid_checkpoint(folder.path()), newer);
  std::filesystem::resize_file(newer, std::filesystem::file_size(newer) / 2);
  EXPECT_EQ(find_newest_valid_checkpoint(folder.path()), older);
}

TEST(Checkpoint, another_scene_is_refused_by_the_names_of_its_columns) {
  const ScratchFolder folder;
  const auto path = write_checkpoint(folder.path(), store_of(10, 1), sample_checkpoint(1), 2);
  parcels::Store dry(3, {{"buoyancy", "m s-2", parcels::Nature::intensive, "", -1, 1, 0},
                         {"smoke", "1", parcels::Nature::intensive, "", 0, 1, 0}});
  const std::string message = message_of(path, dry);
  EXPECT_NE(message.find("lacks [smoke]"), std::string::npos) << message;
  EXPECT_NE(message.find("[total_water]"), std::string::npos) << message;
  parcels::Store flat(2, sample_scalars());
  EXPECT_NE(message_of(path, flat).find("3-dimensional"), std::string::npos);
}

TEST(Checkpoint, derived_scalars_are_not_stored) {
  const ScratchFolder folder;
  const auto path = write_checkpoint(folder.path(), store_of(10, 1), sample_checkpoint(1), 2);
  const CommandResult header = run_command("ncdump -h '" + path.string() + "'");
  EXPECT_NE(header.text.find("total_water"), std::string::npos) << header.text;
  EXPECT_EQ(header.text.find("liquid_water"), std::string::npos);
}

TEST(Checkpoint, missing_folder_is_an_error_with_the_reason) {
  const ScratchFolder folder;
  try {
    write_checkpoint(folder / "gone", store_of(10, 1), sample_checkpoint(1), 2);
    FAIL();
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("checkpoint_000000000001.h5"), std::string::npos) << message;
    EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
  }
}

TEST(Checkpoint, equal_states_give_equal_bytes) {
  const ScratchFolder a, b;
  const auto first = write_checkpoint(a.path(), store_of(100, 1), sample_checkpoint(1), 2);
  const auto second = write_checkpoint(b.path(), store_of(100, 1), sample_checkpoint(1), 2);
  EXPECT_EQ(bytes_of(first), bytes_of(second));
}

TEST(FailureBundle, comes_back_bit_for_bit_and_knows_damage) {
  const ScratchFolder folder;
  const NamedData data = sample_checkpoint(3).data;
  write_failure_bundle(folder / "failure.h5", data);
  EXPECT_EQ(read_failure_bundle(folder / "failure.h5"), data);
  const parcels::Store store = store_of(3, 1);
  const auto checkpoint = write_checkpoint(folder.path(), store, {}, 1);
  EXPECT_THROW(read_failure_bundle(checkpoint), Error);
}

TEST(FailureBundle, names_that_cannot_be_stored_are_refused) {
  const ScratchFolder folder;
  NamedData unnamed, nul;
  unnamed.arrays[""] = {1};
  nul.texts["text"] = std::string("a\0b", 3);
  EXPECT_THROW(write_failure_bundle(folder / "failure.h5", unnamed), std::invalid_argument);
  EXPECT_THROW(write_failure_bundle(folder / "failure.h5", nul), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(StateHash, follows_the_documented_message) {
  parcels::Store store(2, {{"b", "m s-2", parcels::Nature::intensive, "", -1, 1, 0}});
  store.resize(1);
  for (int column = 0; column < store.column_count(); ++column) store.column(column)[0] = column;
  store.uid()[0] = 42;
  const ScratchFolder folder;
  // The digest of the same message, put together by another program.
  const CommandResult result = run_python(folder, R"py(
import hashlib, struct
u = lambda n: struct.pack("<Q", n)
d = lambda x: struct.pack("<d", x)
t = lambda s: u(len(s)) + s.encode()
message = t("pileus state 1") + d(2.5) + u(7) + u(2) + u(1) + u(42)
for n, name in enumerate(["x_position", "z_position", "volume", "vorticity", "B11", "B12", "B22", "b"]):
    message += t(name) + d(n)
message += t("mean_wind") + u(2) + d(3) + d(-4)
print(hashlib.sha256(message).hexdigest(), end="")
)py",
                                          {});
  EXPECT_EQ(state_sha256(store, 2.5, 7, {{"mean_wind", {3, -4}}}), result.text);
}

TEST(StateHash, every_part_of_the_state_counts) {
  parcels::Store store = store_of(20, 5);
  const std::string digest = state_sha256(store, 1, 2);
  EXPECT_NE(state_sha256(store, 1.5, 2), digest);
  EXPECT_NE(state_sha256(store, 1, 3), digest);
  EXPECT_NE(state_sha256(store, 1, 2, {{"u", {}}}), digest);
  for (int column = 0; column < store.state_columns(); ++column) {
    double& value = store.column(column)[13];
    const double before = value;
    value = 0.5;
    EXPECT_NE(state_sha256(store, 1, 2), digest) << store.column_name(column);
    value = before;
  }
  store.uid()[19] ^= 1;
  EXPECT_NE(state_sha256(store, 1, 2), digest);
  store.uid()[19] ^= 1;
  for (int column = store.state_columns(); column < store.column_count(); ++column)
    store.column(column)[3] = 0.25;
  EXPECT_EQ(state_sha256(store, 1, 2), digest) << "derived scalars are no state";
}

}  // namespace
}  // namespace pileus::output

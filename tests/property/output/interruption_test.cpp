// What is left when the process dies or the disk fills at any change of any file.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <random>
#include <thread>

#include "../../unit/output/sample_store.hpp"
#include "../../unit/output/support.hpp"
#include "base/error.hpp"
#include "fault_injection.hpp"
#include "output/checkpoint.hpp"
#include "output/field_file.hpp"
#include "output/parcel_file.hpp"

namespace pileus::output {
namespace {

constexpr std::size_t field_levels = 40, field_nodes = 30 * 30 * field_levels;

std::vector<Axis> axes() {
  std::vector<Axis> result;
  for (const char* name : {"z", "y", "x"}) {
    Axis axis{{name, "m", name}, {}};
    for (std::size_t i = 0; i < (*name == 'z' ? field_levels : 30); ++i)
      axis.values.push_back(static_cast<double>(i));
    result.push_back(std::move(axis));
  }
  return result;
}

/// Record n of every variable holds f(n, i), so that a torn record shows.
double value_at(std::size_t record, std::size_t i) {
  return std::sin(static_cast<double>(i) + 0.1 * static_cast<double>(record));
}

std::vector<std::vector<double>> field_record(std::size_t record) {
  std::vector<double> values(field_nodes);
  for (std::size_t i = 0; i < field_nodes; ++i) values[i] = value_at(record, i);
  return {values, values};
}

FieldFile field_file(const std::filesystem::path& path, Start start) {
  return FieldFile(path, axes(), {{"a", "1", "a"}, {"b", "1", "b"}}, sample_provenance(),
                   {.exact = true}, start);
}

/// The number of records, after checking each of them; −1 where the file cannot be read.
int whole_records(const std::filesystem::path& path) {
  try {
    const hdf5::Session session = hdf5::Session::read(path);
    const auto times = hdf5::read_array<double>(session, session.file(), "time");
    for (const char* name : {"a", "b"}) {
      const auto values = hdf5::read_array<double>(session, session.file(), name);
      if (values.size() != times.size() * field_nodes) return -1;
      for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i] != value_at(i / field_nodes, i % field_nodes)) return -1;
    }
    return static_cast<int>(times.size());
  } catch (const Error&) {
    return -1;
  }
}

parcels::Store store_of(std::size_t size, std::uint64_t seed) {
  parcels::Store store(3, sample_scalars());
  store.resize(size);
  fill_with_numbers(store, seed);
  return store;
}

TEST(Killed, at_any_call_of_the_first_append_leaves_no_half_file) {
  for (int n = 1;; ++n) {
    const ScratchFolder folder;
    const bool died = dies_at(n, [&] {
      FieldFile file = field_file(folder / "fields.nc", Start::fresh());
      file.append(0, field_record(0));
    });
    if (std::filesystem::exists(folder / "fields.nc")) {
      ASSERT_EQ(whole_records(folder / "fields.nc"), 1) << "killed at call " << n;
    }
    if (!died) {
      EXPECT_GT(n, 10) << "the fault has to have hit something";
      break;
    }
  }
}

TEST(Killed, at_any_call_of_an_append_keeps_old_records_and_resumes) {
  int torn_for_others = 0, moments = 0;
  for (int n = 1;; ++n) {
    const ScratchFolder folder;
    const std::filesystem::path path = folder / "fields.nc";
    {
      FieldFile file = field_file(path, Start::fresh());
      for (std::size_t record = 0; record < 3; ++record)
        file.append(static_cast<double>(record), field_record(record));
    }
    const bool died = dies_at(n, [&] {
      FieldFile file = field_file(path, Start::resume_at(1));  // drops record 2
      file.append(2, field_record(2));
      file.append(3, field_record(3));
    });
    const int records = whole_records(path);
    ASSERT_GE(records, 2) << "killed at call " << n;
    moments += died;
    torn_for_others += std::filesystem::exists(path.string() + ".journal");
    {
      FieldFile resumed = field_file(path, Start::resume_at(1));
      ASSERT_EQ(resumed.records().times().size(), 2u) << "killed at call " << n;
      resumed.append(2, field_record(2));
    }
    ASSERT_EQ(whole_records(path), 3) << "killed at call " << n;
    ASSERT_FALSE(std::filesystem::exists(path.string() + ".journal"));
    if (!died) break;
  }
  EXPECT_GT(moments, 20);
  EXPECT_GT(torn_for_others, 0) << "some kills have to fall between journal and file";
}

TEST(Killed, at_any_call_of_a_parcel_append_keeps_old_records) {
  const parcels::Store store = store_of(300, 1), more = store_of(40000, 2);
  for (int n = 1;; ++n) {
    const ScratchFolder folder;
    const std::filesystem::path path = folder / "parcels.nc";
    auto open = [&](Start start) {
      return ParcelFile(path, 3, {{"buoyancy", "m s-2", "buoyancy"}}, sample_provenance(),
                        {.exact = true}, start);
    };
    open(Start::fresh()).append(0, store);
    const bool died = dies_at(n, [&] { open(Start::resume_at(0)).append(1, more); });
    {
      ParcelFile resumed = open(Start::resume_at(0));
      ASSERT_EQ(resumed.row_sizes(), std::vector<std::uint64_t>{300}) << "killed at call " << n;
      resumed.append(1, more);
    }
    const hdf5::Session session = hdf5::Session::read(path);
    std::vector<double> expected(store.scalar(0), store.scalar(0) + 300);
    expected.insert(expected.end(), more.scalar(0), more.scalar(0) + 40000);
    ASSERT_EQ(hdf5::read_array<double>(session, session.file(), "parcels/buoyancy"), expected)
        << "killed at call " << n;
    if (!died) break;
  }
}

TEST(Killed, at_any_call_of_a_checkpoint_leaves_a_valid_one) {
  // Columns of 80 kB go to the file one by one, everything smaller at the end.
  const parcels::Store old_state = store_of(50, 1), new_state = store_of(10000, 2);
  for (int n = 1;; ++n) {
    const ScratchFolder folder;
    write_checkpoint(folder.path(), old_state, {1, 1, 0.1, {}}, 2);
    const bool died = dies_at(n, [&] {
      write_checkpoint(folder.path(), new_state, {2, 2, 0.1, {}}, 1);
    });
    const auto newest = find_newest_valid_checkpoint(folder.path());
    ASSERT_TRUE(newest) << "killed at call " << n;
    parcels::Store back(3, sample_scalars());
    const Checkpoint read = read_checkpoint(*newest, back);
    ASSERT_TRUE(same_state(back, read.step == 1 ? old_state : new_state)) << "at call " << n;
    if (!died) {
      EXPECT_EQ(read.step, 2u);
      EXPECT_GT(n, 20);
      break;
    }
  }
}

TEST(Killed, at_random_moments_the_files_open_in_other_programs) {
  const ScratchFolder folder;
  std::mt19937_64 random(3);
  std::vector<std::filesystem::path> files;
  for (int trial = 0; trial < 12; ++trial) {
    const std::filesystem::path path = folder / ("killed" + std::to_string(trial) + ".nc");
    const pid_t child = fork();
    if (child == 0) {
      SeriesFile file(path, {{"a", "1", "a"}}, sample_provenance(), Start::fresh());
      for (int n = 0;; ++n) file.append(n, std::vector<double>{2.0 * n});
    }
    while (!std::filesystem::exists(path)) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(500 + random() % 20000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    files.push_back(path);
  }
  const CommandResult result = run_python(folder, R"py(
import sys, xarray
for path in sys.argv[1:]:
    for engine in ("netcdf4", "h5netcdf"):
        with xarray.open_dataset(path, engine=engine, decode_times=False) as d:
            assert d.time.size > 0 and (d.a == 2 * d.time).all()
)py",
                                          files);
  EXPECT_EQ(result.status, 0) << result.text;
}

TEST(Running, other_programs_read_while_records_are_appended) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "fields.nc";
  const pid_t writer = fork();
  if (writer == 0) {
    FieldFile file = field_file(path, Start::fresh());
    for (std::size_t n = 0;; ++n) {
      file.append(static_cast<double>(n), field_record(n));
      std::this_thread::sleep_for(std::chrono::milliseconds(25));
    }
  }
  while (!std::filesystem::exists(path)) std::this_thread::yield();
  const CommandResult result = run_python(folder, R"py(
import sys, time, netCDF4, xarray, numpy
def look(engine):
    with xarray.open_dataset(sys.argv[1], engine=engine, decode_times=False) as d:
        last, n = d.a[d.time.size - 1].values.ravel(), float(d.time[d.time.size - 1])
    # The fill value of the netCDF library: the length came from after an append, the time from before.
    if n == netCDF4.default_fillvals["f8"]: raise EOFError
    return last, n
reads, again, records = 0, 0, set()
until = time.time() + 2
while time.time() < until or len(records) < 3:
    engine = ("netcdf4", "h5netcdf")[reads % 2]
    # A reader that fetches one part before and one after an append may see the end of the file
    # twice: that has to show as an error or a missing time, never as wrong numbers.
    for attempt in range(10):
        try:
            last, n = look(engine)
            break
        except Exception:
            again += 1
            assert attempt < 9
    expected = numpy.sin(numpy.arange(last.size) + 0.1 * n)
    assert numpy.allclose(last, expected, rtol=0, atol=1e-12), n
    records.add(n)
    reads += 1
print(reads, "reads,", again, "repeated,", len(records), "states")
)py",
                                          {path});
  kill(writer, SIGKILL);
  waitpid(writer, nullptr, 0);
  EXPECT_EQ(result.status, 0) << result.text;
  std::cout << result.text;
}

TEST(DiskFull, at_any_write_of_an_append_keeps_the_file_as_it_was) {
  for (int n = 1;; ++n) {
    const ScratchFolder folder;
    const std::filesystem::path path = folder / "fields.nc";
    FieldFile file = field_file(path, Start::fresh());
    file.append(0, field_record(0));
    const std::string before = bytes_of(path);
    inject_fault(Fault::no_space, n);
    bool failed = false;
    std::string message;
    try {
      file.append(1, field_record(1));
    } catch (const Error& error) {
      failed = true;
      message = error.what();
      EXPECT_EQ(error.code(), ExitCode::file);
    }
    inject_fault(Fault::none, 0);
    if (!failed) {
      EXPECT_GT(n, 3);
      break;
    }
    EXPECT_NE(message.find("No space left on device"), std::string::npos) << message;
    const bool decided = std::filesystem::exists(path.string() + ".journal");
    if (!decided && message.find("fields.nc") != std::string::npos) {
      ASSERT_EQ(bytes_of(path), before) << "at call " << n;
    }
    ASSERT_GE(whole_records(path), 1) << "at call " << n;
    if (message.find("fields.nc") == std::string::npos) continue;  // only the sidecar failed
    FieldFile again = field_file(path, Start::resume_at(0));
    again.append(1, field_record(1));
    ASSERT_EQ(whole_records(path), 2) << "at call " << n;
  }
}

TEST(DiskFull, at_any_write_of_a_checkpoint_keeps_the_one_before) {
  const parcels::Store store = store_of(10000, 1);
  for (int n = 1;; ++n) {
    const ScratchFolder folder;
    const auto older = write_checkpoint(folder.path(), store, {1, 1, 0.1, {}}, 2);
    const std::string before = bytes_of(older);
    inject_fault(Fault::no_space, n);
    std::string message;
    try {
      write_checkpoint(folder.path(), store, {2, 2, 0.1, {}}, 2);
    } catch (const Error& error) {
      message = error.what();
    }
    inject_fault(Fault::none, 0);
    ASSERT_EQ(bytes_of(older), before);
    if (message.empty()) {
      EXPECT_GT(n, 5);
      break;
    }
    EXPECT_NE(message.find("checkpoint_000000000002.h5"), std::string::npos) << message;
    EXPECT_NE(message.find("No space left on device"), std::string::npos) << message;
    ASSERT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
        << "a failed checkpoint leaves nothing beside";
  }
}

TEST(DiskFull, a_file_size_limit_is_an_error_and_not_a_signal) {
  const ScratchFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{1 << 20, 1 << 20};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_checkpoint(folder.path(), store_of(100000, 1), {1, 1, 0.1, {}}, 2);
    } catch (const Error& error) {
      _exit(std::string(error.what()).find("File too large") != std::string::npos ? 42 : 1);
    }
    _exit(2);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 42);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Damage, of_a_checkpoint_by_truncation_is_noticed_at_every_length) {
  const ScratchFolder folder;
  const parcels::Store store = store_of(100, 1);
  const auto path = write_checkpoint(folder.path(), store, {1, 1, 0.1, {}}, 2);
  const std::string whole = bytes_of(path);
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 300; ++trial) {
    std::filesystem::resize_file(path, random() % whole.size());
    EXPECT_THROW(verify_checkpoint(path), Error);
  }
}

TEST(Damage, of_a_checkpoint_by_a_flipped_bit_is_noticed_at_every_place) {
  const ScratchFolder folder;
  const parcels::Store store = store_of(100, 1);
  Checkpoint written{1, 1, 0.1, {}};
  written.data.arrays["mean_wind"] = {1, 2};
  written.data.texts["scene"] = "name: x";
  const auto path = write_checkpoint(folder.path(), store, written, 2);
  const std::string whole = bytes_of(path);
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 500; ++trial) {
    std::string damaged = whole;
    damaged[random() % whole.size()] ^= static_cast<char>(1 << random() % 8);
    std::ofstream(path, std::ios::binary) << damaged;
    parcels::Store back(3, sample_scalars());
    EXPECT_THROW(read_checkpoint(path, back), Error) << "trial " << trial;
    EXPECT_EQ(back.size(), 0u) << "the store is touched only by a whole checkpoint";
  }
}

}  // namespace
}  // namespace pileus::output

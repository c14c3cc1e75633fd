#include "output/run_directory.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "base/error.hpp"
#include "output/posix_file.hpp"
#include "support.hpp"

namespace pileus::output {
namespace {

using Mode = RunDirectory::Mode;

std::string refusal(const std::filesystem::path& folder, Mode mode) {
  try {
    RunDirectory directory(folder, mode);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::file);
    return error.what();
  }
  return {};
}

int status_of_child(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(RunDirectory, creates_nested_folders_and_holds_the_lock) {
  const ScratchFolder folder;
  {
    const RunDirectory directory(folder / "a/b/c", Mode::fresh);
    EXPECT_TRUE(std::filesystem::exists(directory / "run.lock"));
    const std::string message = refusal(folder / "a/b/c", Mode::resume);
    EXPECT_NE(message.find("in use by process " + std::to_string(getpid())), std::string::npos)
        << message;
    replace_file(directory / "summary.json", "{}");
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "a/b/c/run.lock"));
  EXPECT_TRUE(std::filesystem::exists(folder / "a/b/c/summary.json"));
}

TEST(RunDirectory, unused_new_folder_disappears_again) {
  const ScratchFolder folder;
  { const RunDirectory directory(folder / "run", Mode::fresh); }
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
  std::filesystem::create_directory(folder / "mine");
  { const RunDirectory directory(folder / "mine", Mode::fresh); }
  EXPECT_TRUE(std::filesystem::exists(folder / "mine"));
}

TEST(RunDirectory, a_run_is_not_overwritten_without_being_told) {
  for (const char* file : {"summary.json", "fields.nc", "checkpoint_000000000001.h5"}) {
    const ScratchFolder folder;
    std::ofstream(folder / file) << "precious";
    std::ofstream(folder / "notes.txt") << "mine";
    const std::string message = refusal(folder.path(), Mode::fresh);
    EXPECT_NE(message.find("holds a run"), std::string::npos) << message;
    EXPECT_FALSE(std::filesystem::exists(folder / "run.lock"));
    EXPECT_EQ(refusal(folder.path(), Mode::resume), "");
    const RunDirectory directory(folder.path(), Mode::force);
    EXPECT_EQ(bytes_of(folder / file), "precious") << "deleted before the scene was validated";
    directory.remove_previous_run();
    EXPECT_FALSE(std::filesystem::exists(folder / file));
    EXPECT_EQ(bytes_of(folder / "notes.txt"), "mine");
  }
}

TEST(RunDirectory, foreign_files_do_not_make_a_run) {
  const ScratchFolder folder;
  std::ofstream(folder / "notes.txt") << "mine";
  EXPECT_EQ(refusal(folder.path(), Mode::fresh), "");
}

TEST(RunDirectory, lock_of_a_dead_process_is_taken_over) {
  const ScratchFolder folder;
  ASSERT_EQ(status_of_child([&] {
              new RunDirectory(folder.path(), Mode::fresh);  // dies holding it
              return 7;
            }),
            7);
  EXPECT_TRUE(std::filesystem::exists(folder / "run.lock"));
  EXPECT_EQ(reason_in_use(folder.path()), "");
  EXPECT_EQ(refusal(folder.path(), Mode::fresh), "");
}

TEST(RunDirectory, lock_of_a_recycled_process_number_is_taken_over) {
  const ScratchFolder folder;
  std::string host(256, '\0');
  gethostname(host.data(), host.size());
  // Process 1 lives, but it did not start at clock tick 999999999999.
  std::ofstream(folder / "run.lock") << "1 999999999999 " << host.c_str() << "\n";
  EXPECT_EQ(refusal(folder.path(), Mode::fresh), "");
}

TEST(RunDirectory, lock_of_a_living_process_or_another_host_is_respected) {
  const ScratchFolder folder;
  std::ofstream(folder / "run.lock") << "1 1 another-host.example\n";
  const std::string message = refusal(folder.path(), Mode::force);
  EXPECT_NE(message.find("process 1 on another-host.example"), std::string::npos) << message;
  EXPECT_EQ(reason_in_use(folder.path()), message);
  EXPECT_TRUE(std::filesystem::exists(folder / "run.lock"));
  std::filesystem::remove(folder / "run.lock");

  const RunDirectory directory(folder.path(), Mode::fresh);
  EXPECT_EQ(status_of_child([&] { return refusal(folder.path(), Mode::fresh).empty() ? 1 : 0; }),
            0);
}

TEST(RunDirectory, of_many_processes_one_gets_a_dead_lock) {
  const ScratchFolder folder;
  status_of_child([&] {
    new RunDirectory(folder.path(), Mode::fresh);
    return 0;
  });
  std::vector<pid_t> children;
  int gate[2], hold[2];
  ASSERT_EQ(pipe(gate), 0);
  ASSERT_EQ(pipe(hold), 0);
  for (int n = 0; n < 16; ++n) {
    children.push_back(fork());
    if (children.back() == 0) {
      close(gate[1]);
      close(hold[1]);
      char byte;
      if (read(gate[0], &byte, 1) < 0) _exit(2);  // all start together
      try {
        const RunDirectory directory(folder.path(), Mode::fresh);
        if (read(hold[0], &byte, 1) < 0) _exit(2);  // holds it until all have tried
        _exit(0);
      } catch (const Error&) {
        _exit(1);
      }
    }
  }
  close(gate[0]);
  close(gate[1]);
  int got = 0, refused = 0;
  for (int n = 0; n < 15; ++n) {
    int status = 0;
    ASSERT_GT(wait(&status), 0);
    refused += WEXITSTATUS(status) == 1;
  }
  close(hold[1]);
  int status = 0;
  ASSERT_GT(wait(&status), 0);
  got = WEXITSTATUS(status) == 0;
  close(hold[0]);
  EXPECT_EQ(refused, 15);
  EXPECT_EQ(got, 1);
}

TEST(RunDirectory, a_file_in_the_way_is_named) {
  const ScratchFolder folder;
  std::ofstream(folder / "run") << "a file";
  const std::string message = refusal(folder / "run", Mode::fresh);
  EXPECT_NE(message.find("run: cannot create the folder"), std::string::npos) << message;
  EXPECT_EQ(bytes_of(folder / "run"), "a file");
}

TEST(ReplaceFile, replaces_whole_texts_and_leaves_nothing_beside) {
  const ScratchFolder folder;
  replace_file(folder / "status.json", "one");
  replace_file(folder / "status.json", "2");
  EXPECT_EQ(read_text_file(folder / "status.json"), "2");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(ReplaceFile, a_reader_never_sees_a_part) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "status.json";
  replace_file(path, std::string(5000, 'a'));
  const pid_t writer = fork();
  if (writer == 0)
    for (char c = 'a';; c = c == 'z' ? 'a' : static_cast<char>(c + 1))
      replace_file(path, std::string(c % 2 == 0 ? 5000 : 90000, c));
  for (int n = 0; n < 3000; ++n) {
    const std::string text = read_text_file(path);
    ASSERT_TRUE(text.size() == 5000 || text.size() == 90000) << text.size();
    ASSERT_EQ(text.find_first_not_of(text[0]), std::string::npos);
  }
  kill(writer, SIGKILL);
  waitpid(writer, nullptr, 0);
}

}  // namespace
}  // namespace pileus::output

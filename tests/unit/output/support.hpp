// What the tests of the output layer share: a scratch folder, commands, a provenance.
#pragma once
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "output/provenance.hpp"

namespace pileus::output {

/// A folder that disappears with the test.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "pileus-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no scratch folder");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

struct CommandResult {
  int status = -1;   // of the shell
  std::string text;  // standard output and error
};

inline CommandResult run_command(const std::string& command) {
  CommandResult result;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return result;
  std::array<char, 4096> buffer;
  while (const std::size_t count = fread(buffer.data(), 1, buffer.size(), pipe))
    result.text.append(buffer.data(), count);
  result.status = pclose(pipe);
  return result;
}

/// Runs a Python program given as text, with `arguments` as its sys.argv[1:]; the system's
/// interpreter has xarray and both engines.
inline CommandResult run_python(const ScratchFolder& folder, const std::string& program,
                                const std::vector<std::filesystem::path>& arguments) {
  const std::filesystem::path file = folder / "check.py";
  std::ofstream(file) << program;
  std::string command = "/usr/bin/python3 -W ignore '" + file.string() + "'";
  for (const auto& argument : arguments) command += " '" + argument.string() + "'";
  return run_command(command);
}

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline Provenance sample_provenance() {
  return {"A thermal",
          "Pileus 0.0.0 (commit abc)",
          "made by a test",
          "name: thermal\ndomain: 1 m\n",
          {{"initial", 18446744073709551615u}, {"noise", 7}},
          {{"institution", "none"}}};
}

}  // namespace pileus::output

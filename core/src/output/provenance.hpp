// Where a file comes from: written into every file the model produces.
#pragma once
#include <cstdint>
#include <map>
#include <string>

namespace pileus::output {

struct Provenance {
  std::string title;                                // one line for people
  std::string source;                               // program, version and commit
  std::string history;                              // what was called, when; one line per entry
  std::string scene;                                // the resolved scene as YAML
  std::map<std::string, std::uint64_t> seeds;       // written as attributes seed_<name>
  std::map<std::string, std::string> attributes{};  // further global attributes
};

}  // namespace pileus::output

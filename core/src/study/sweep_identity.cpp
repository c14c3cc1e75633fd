#include "study/sweep_identity.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.hpp"
#include "output/posix_file.hpp"

namespace pileus::study {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr const char* identity_file = "identity.json";
/// What a sweep would overwrite.
constexpr std::array<const char*, 6> own_files = {"sweep.json",  "members.tsv", "members",
                                                  "members.csv", "ensemble.nc", "sweep.sbatch"};
constexpr const char* ways_out =
    "Choose another folder with --out, or take this one over with --force.";

struct Identity {
  std::string name;
  fs::path file;       // absolute; empty: not known
  fs::path from_here;  // the same from the sweep's folder
};

std::string text_in(const Json& json, const char* name) {
  const auto entry = json.find(name);
  return entry != json.end() && entry->is_string() ? entry->get<std::string>() : std::string();
}

/// What the folder says of itself; releases before identity.json had the name in sweep.json alone.
std::optional<Identity> identity_in(const fs::path& folder) {
  for (const char* name : {identity_file, "sweep.json"}) {
    std::ifstream file(folder / name);
    const Json json = Json::parse(file, nullptr, false);
    if (json.is_object() && !text_in(json, "sweep").empty())
      return Identity{text_in(json, "sweep"), text_in(json, "file"), text_in(json, "from_here")};
  }
  return std::nullopt;
}

Identity identity_of(const Sweep& sweep, const fs::path& folder) {
  std::error_code error;
  fs::path file = fs::weakly_canonical(sweep.path, error);
  if (error) file = fs::absolute(sweep.path);  // a pipe
  return {sweep.name, file, file.lexically_relative(fs::weakly_canonical(folder))};
}

/// Whether both are one sweep, the first as the folder has it.
bool is_same_sweep(const Identity& held, const Identity& ours, const fs::path& folder) {
  bool exists = false;
  for (const fs::path& place : {held.file, folder / held.from_here}) {
    std::error_code none;
    if (held.file.empty() || !fs::is_regular_file(place, none)) continue;
    if (fs::equivalent(place, ours.file, none)) return true;
    exists = true;
  }
  return !exists && held.name == ours.name;
}

void refuse_strangers(const fs::path& folder, const Identity& ours) {
  if (const auto held = identity_in(folder)) {
    if (is_same_sweep(*held, ours, folder)) return;
    throw Error(ExitCode::file,
                fmt::format("{}: the folder holds the sweep '{}'{}, not '{}' of {}. {}",
                            folder.string(), held->name,
                            held->file.empty() ? "" : fmt::format(" of {}", held->file.string()),
                            ours.name, ours.file.string(), ways_out));
  }
  for (const char* name : own_files)
    if (fs::exists(folder / name))
      throw Error(ExitCode::file,
                  fmt::format("{}: the folder holds {}, but does not say of which sweep (there is "
                              "no {}); '{}' of {} would replace it. {}",
                              folder.string(), name, identity_file, ours.name, ours.file.string(),
                              ways_out));
}

/// Writes the identity aside and puts it in place whole; `false`: another one is there.
bool put(const fs::path& folder, const Identity& identity, bool replace) {
  const Json json = {{"sweep", identity.name},
                     {"file", identity.file.string()},
                     {"from_here", identity.from_here.string()}};
  const fs::path place = folder / identity_file;
  const fs::path aside =
      folder / fmt::format("{}.{}.{}", identity_file, getpid(),
                           std::chrono::system_clock::now().time_since_epoch().count());
  output::replace_file(aside, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  std::error_code error;
  if (!replace) fs::create_hard_link(aside, place, error);  // refuses one that exists
  const bool exists = error == std::errc::file_exists;
  if (replace || (error && !exists)) {  // or a file system without such links
    fs::rename(aside, place);
    return true;
  }
  fs::remove(aside);
  return !exists;
}

}  // namespace

void claim_folder(const fs::path& folder, const Sweep& sweep, bool by_force) {
  const Identity ours = identity_of(sweep, folder);
  if (!by_force) refuse_strangers(folder, ours);
  fs::create_directories(folder);
  const auto held = identity_in(folder);
  if (held && held->name == ours.name && held->file == ours.file &&
      held->from_here == ours.from_here)
    return;
  const bool replace = fs::exists(folder / identity_file);  // by force, edited or moved
  if (!put(folder, ours, replace)) refuse_strangers(folder, ours);
}

}  // namespace pileus::study

// Checkpoints: everything needed to continue a run bit for bit, in one file.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "output/named_data.hpp"
#include "parcels/store.hpp"

namespace pileus::output {

/// The state beside the parcels. `data` takes whatever the layers above need to continue: mean
/// wind, private state of operators, accumulated diagnostics, the resolved scene, seeds, versions.
struct Checkpoint {
  double time = 0;         // s
  std::uint64_t step = 0;  // completed steps
  double dt = 0;           // s, of the last step
  NamedData data;
};

/// Writes `folder`/checkpoint_<step>.h5: aside, synced, renamed, folder synced; then removes all
/// but the newest `keep` (≥ 1) checkpoints. State columns and uids are stored exactly, in the order
/// of memory, and the file ends with the SHA-256 of all its bytes (seal.hpp). Throws
/// Error(ExitCode::file); every earlier checkpoint is then untouched. Returns the path.
std::filesystem::path write_checkpoint(const std::filesystem::path& folder,
                                       const parcels::Store& store, const Checkpoint& checkpoint,
                                       int keep);

/// Reads a checkpoint into `store`, whose state columns have to be those of the file. Throws
/// Error(ExitCode::file) when the file is damaged (the store is then undefined) or when its columns
/// differ.
Checkpoint read_checkpoint(const std::filesystem::path& path, parcels::Store& store);

/// Throws Error(ExitCode::file) saying what is wrong, if anything is.
void verify_checkpoint(const std::filesystem::path& path);

/// The checkpoints of a folder, newest first.
std::vector<std::filesystem::path> list_checkpoints(const std::filesystem::path& folder);

/// The newest checkpoint that is whole; damaged ones are logged as warnings and skipped.
std::optional<std::filesystem::path> find_newest_valid_checkpoint(
    const std::filesystem::path& folder);

}  // namespace pileus::output

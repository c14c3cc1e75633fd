// Whose results the folder of a sweep holds: kept in identity.json there.
#pragma once
#include <filesystem>

#include "study/sweep_file.hpp"

namespace pileus::study {

/// Takes the folder for the results of a sweep, before anything else is written there. Whether it
/// may depends on the file of the sweep, wherever the folder says that this is: by its path or by
/// the way from the folder, so that both may be moved together. A file that is at neither place
/// any more was moved; then the name decides. Of several processes that take a new folder at once
/// one writes; the others find its sweep there.
///
/// `by_force`: take it whatever it holds.
/// Throws Error(file) when it holds another sweep, or members or collected files of none that is
/// known; nothing has been changed then.
void claim_folder(const std::filesystem::path& folder, const Sweep& sweep, bool by_force);

}  // namespace pileus::study

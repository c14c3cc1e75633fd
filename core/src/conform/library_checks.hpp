// Checks of a library as a file and of its tables as a whole: C01, C02, C03 and C07.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pileus::conform {

/// A library that cannot be loaded, or can: what is wrong, by the check that it is a matter of.
struct LibraryFindings {
  struct Complaint {
    std::string check, text;
    bool fatal = false;  // it cannot be loaded
  };
  std::vector<Complaint> complaints;
  std::vector<std::string> operators;  // ids, when it can be loaded
};

/// Reads the file; none of its code runs.
LibraryFindings examine_file(const std::filesystem::path& path);
/// Loads the library into this process. Everything the loader refuses is sorted by what it is
/// about; a library without complaints has its operators.
LibraryFindings examine_tables(const std::filesystem::path& path);

/// What a library declares, as one text, to compare processes by.
std::string declarations_of(const std::filesystem::path& path);

}  // namespace pileus::conform

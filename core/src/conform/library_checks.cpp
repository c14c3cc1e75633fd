#include "conform/library_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

#include "base/error.hpp"
#include "base/version.hpp"
#include "host/describe.hpp"
#include "host/elf.hpp"
#include "host/library.hpp"
#include "host/row_rules.hpp"
#include "host/symbol_provider.hpp"

namespace pileus::conform {
namespace {

namespace fs = std::filesystem;

/// What a plugin may link: C, its mathematics, C++ and the compiler's own support. Functions of the
/// C library that read a clock may be the kernel's own (linux-vdso).
constexpr std::array<std::string_view, 9> allowed_libraries = {
    "libc.so",       "libm.so",  "libstdc++.so", "libgcc_s.so", "ld-linux",
    "libpthread.so", "libdl.so", "librt.so",     "linux-vdso"};

bool is_allowed(const std::string& library) {
  const std::string name = fs::path(library).filename();
  return std::any_of(allowed_libraries.begin(), allowed_libraries.end(),
                     [&](std::string_view prefix) { return name.starts_with(prefix); });
}

/// Words of a sentence about a table, and the check that it is a matter of; the first that occurs
/// decides, anything else is a matter of form (C03).
struct Subject {
  const char *words, *check;
};
constexpr std::array<Subject, 17> subjects = {{
    {"different interface versions", "C01"},
    {"is not named after its module", "C01"},
    {"licence", "C06"},
    {"summary", "C06"},
    {"authors", "C06"},
    {"title", "C06"},
    {"names no weight", "C05"},
    {"nature", "C05"},
    {"budget", "C05"},
    {"is derived but", "C05"},
    {"is written by", "C05"},
    {"has a name that", "C04"},
    {"initial value", "C04"},
    {"range", "C04"},
    {"default", "C04"},
    {"ladder", "C04"},
    {"units", "C04"},
}};

std::string check_of(const std::string& complaint) {
  for (const auto& [words, check] : subjects)
    if (complaint.find(words) != std::string::npos) return check;
  return "C03";
}

std::string without_path(const std::string& text) {
  const std::size_t colon = text.find("is refused: ");
  return colon == std::string::npos ? text : text.substr(colon + 12);
}

/// The loader's list of complaints, one a line behind a dash; a refusal without a list is one.
void sort_complaints(const std::string& refusal, LibraryFindings& findings) {
  std::istringstream lines(refusal);
  bool any = false;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t dash = line.find("  - ");
    if (dash != 0) continue;
    any = true;
    findings.complaints.push_back({check_of(line), line.substr(4), true});
  }
  if (!any) findings.complaints.push_back({"C03", without_path(refusal), true});
}

void examine_note(const host::LibraryNote& note, LibraryFindings& findings) {
  const auto require = [&](bool holds, const std::string& text) {
    if (!holds) findings.complaints.push_back({"C01", text, false});
  };
  require(!note.module.empty(), "its note names no module");
  require(
      host::is_semantic_version(note.version),
      fmt::format("its note has the version '{}', which is not of the form 1.0.0", note.version));
  require(!note.toolchain.empty(), "its note names no toolchain");
  require(note.abi_minor_needed <= note.abi_minor_built,
          "its note needs a newer interface than it was built with");
}

/// A sanitizer brings functions of its own for half of the C library.
void examine_links(const host::ElfFacts& facts, LibraryFindings& findings) {
  const auto complain = [&](const std::string& text) {
    findings.complaints.push_back({"C02", text, false});
  };
  if (facts.has_text_relocations)
    complain("the loader has to write into its code: build it with -fPIC");
  if (!build_record().sanitizer.empty()) return;
  for (const std::string& library : facts.needed)
    if (!is_allowed(library))
      complain(
          fmt::format("it links {}; a plugin links nothing but the C and C++ libraries, what "
                      "else it uses it carries inside",
                      library));
  for (const std::string& symbol : facts.undefined) {
    const std::string provider = host::provider_of(symbol);
    if (provider.empty() || !is_allowed(provider))
      complain(fmt::format("it needs the symbol '{}', which neither the C nor the C++ library has",
                           symbol));
  }
}

}  // namespace

LibraryFindings examine_file(const fs::path& path) {
  LibraryFindings findings;
  try {
    examine_note(host::inspect_library(path), findings);
    examine_links(host::read_elf(path), findings);
  } catch (const Error& error) {
    const std::string text = without_path(error.what());
    const bool of_symbols = text.find("export") != std::string::npos;
    findings.complaints.push_back({of_symbols ? "C02" : "C01", text, true});
  }
  return findings;
}

LibraryFindings examine_tables(const fs::path& path) {
  LibraryFindings findings;
  try {
    for (const host::OperatorTable& table : host::load_library(path).operators)
      findings.operators.emplace_back(table.op.id);
  } catch (const Error& error) {
    sort_complaints(error.what(), findings);
  }
  return findings;
}

std::string declarations_of(const fs::path& path) {
  return host::describe_json(host::load_library(path));
}

}  // namespace pileus::conform

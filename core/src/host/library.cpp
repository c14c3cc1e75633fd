#include "host/library.hpp"

#include <dlfcn.h>

#include <cstring>
#include <set>
#include <stdexcept>

#include "base/error.hpp"
#include "host/breadcrumb.hpp"
#include "host/elf.hpp"
#include "host/floating_point.hpp"
#include "host/row_rules.hpp"

namespace pileus::host {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool host_is_sanitized = true;
#else
constexpr bool host_is_sanitized = false;
#endif

constexpr const char* rebuild = "rebuild it with the headers of this Pileus (pileus_add_plugin)";

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw Error(ExitCode::plugin, "plugin library '" + path.string() + "' is refused: " + why);
}

void judge_version(const std::filesystem::path& path, const pileus_note& note) {
  if (note.abi_major != PILEUS_ABI_MAJOR) {
    refuse(path, "it is built for major version " + std::to_string(note.abi_major) +
                     " of the plugin interface, this program has " +
                     std::to_string(PILEUS_ABI_MAJOR) + "; " + rebuild);
  }
  if (note.abi_minor_needed > PILEUS_ABI_MINOR) {
    refuse(path, "it needs plugin interface " + std::to_string(note.abi_major) + "." +
                     std::to_string(note.abi_minor_needed) + ", this program has " +
                     std::to_string(PILEUS_ABI_MAJOR) + "." + std::to_string(PILEUS_ABI_MINOR) +
                     "; use a newer Pileus or " + rebuild);
  }
}

void judge_note(const std::filesystem::path& path, const ElfFacts& facts) {
  if (!facts.has_note) {
    refuse(path, std::string("it carries no section '") + PILEUS_NOTE_SECTION +
                     "', so it is not a Pileus plugin; end its source with PILEUS_PLUGIN(…)");
  }
  char magic[sizeof facts.note.magic] = {};
  std::memcpy(magic, PILEUS_NOTE_MAGIC, sizeof PILEUS_NOTE_MAGIC);
  if (std::memcmp(facts.note.magic, magic, sizeof magic) != 0) {
    refuse(path,
           std::string("its note does not begin with '") + PILEUS_NOTE_MAGIC + "'; " + rebuild);
  }
  judge_version(path, facts.note);
  if ((facts.note.build_flags & PILEUS_BUILT_FASTMATH) != 0) {
    refuse(path,
           "it is built with fast-math, which changes results and the arithmetic of the whole "
           "process; rebuild it without -ffast-math");
  }
  if ((facts.note.build_flags & PILEUS_BUILT_SANITIZED) != 0 && !host_is_sanitized) {
    refuse(path,
           "it is built with a sanitizer and this program is not; rebuild it without, or run the "
           "sanitizer's build of Pileus");
  }
}

void judge_exports(const std::filesystem::path& path, const ElfFacts& facts) {
  bool has_entry = false;
  std::string others;
  for (const std::string& name : facts.exports) {
    if (name == PILEUS_ENTRY_SYMBOL) {
      has_entry = true;
    } else if (others.size() < 200) {
      others += (others.empty() ? "" : ", ") + name;
    }
  }
  if (!has_entry) {
    refuse(path, std::string("it does not export the entry function '") + PILEUS_ENTRY_SYMBOL +
                     "'; end its source with PILEUS_PLUGIN(…)");
  }
  if (!others.empty()) {
    refuse(path, std::string("it exports more than the entry function: ") + others +
                     "; build it with pileus_add_plugin, which hides everything else");
  }
}

std::string joined(const std::vector<std::string>& complaints) {
  std::string text;
  for (const std::string& complaint : complaints) text += "\n  - " + complaint;
  return text;
}

using Entry = const pileus_module* (*)();

Entry open_entry(const std::filesystem::path& path) {
  const FloatingPointGuard restore;
  ::dlerror();
  void* handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle == nullptr) {
    const char* reason = ::dlerror();
    refuse(path, std::string("it cannot be loaded: ") + (reason != nullptr ? reason : "unknown"));
  }
  void* symbol = ::dlsym(handle, PILEUS_ENTRY_SYMBOL);
  if (symbol == nullptr) refuse(path, "its entry function cannot be found after loading");
  Entry entry;
  std::memcpy(&entry, &symbol, sizeof entry);
  return entry;
}

const pileus_module* call_entry(const std::filesystem::path& path, Entry entry) {
  const pileus_module* module = nullptr;
  try {
    module = entry();
  } catch (...) {
    refuse(path, "its entry function threw an exception; it must not fail");
  }
  if (module == nullptr) refuse(path, "its entry function returned NULL");
  if (module->size < first_size<pileus_module> || module->size > largest_row) {
    refuse(path, "its module table has size " + std::to_string(module->size) + " where at least " +
                     std::to_string(first_size<pileus_module>) + " is needed; " + rebuild);
  }
  return module;
}

/// Ids belong to their module, so that a library can be found by id from its note alone.
bool belongs(const std::string& id, const std::string& module) {
  return id == module || id.compare(0, module.size() + 1, module + ".") == 0;
}

void read_module(const pileus_module& module, Library& library) {
  std::vector<std::string> complaints;
  if (module.abi_minor_built != library.note.abi_minor_built ||
      module.abi_minor_needed != library.note.abi_minor_needed) {
    complaints.push_back("its module table and its note state different interface versions");
  }
  Complaints(complaints).reserved(module.reserved, "its module table");
  if (module.operators == nullptr || *module.operators == nullptr) {
    complaints.push_back(
        "it declares no operators (a describe function that throws has this effect too)");
  }
  std::set<std::string> ids;
  for (const pileus_operator* const* row = module.operators; row != nullptr && *row != nullptr;
       ++row) {
    if (library.operators.size() == longest_list) {
      complaints.push_back("its list of operators has no end: it must close with a null pointer");
      break;
    }
    std::vector<std::string> own;
    OperatorTable table = read_operator(*row, own);
    const std::string id = table.op.id != nullptr ? table.op.id : "";
    for (const std::string& text : own) complaints.push_back("operator '" + id + "': " + text);
    if (!ids.insert(id).second) complaints.push_back("operator '" + id + "' is declared twice");
    if (own.empty() && !belongs(id, library.note.module)) {
      complaints.push_back("operator '" + id + "' is not named after its module '" +
                           library.note.module + "'");
    }
    table.library = library.path.string();
    table.module = library.note.module;
    table.module_version = library.note.version;
    table.toolchain = library.note.toolchain;
    library.operators.push_back(std::move(table));
  }
  if (!complaints.empty()) refuse(library.path, "its tables are wrong:" + joined(complaints));
}

}  // namespace

LibraryNote inspect_library(const std::filesystem::path& path) {
  ElfFacts facts;
  try {
    facts = read_elf(path);
  } catch (const std::invalid_argument& reason) {
    refuse(path, std::string("the file ") + reason.what());
  }
  judge_note(path, facts);
  judge_exports(path, facts);
  const pileus_note& note = facts.note;
  return {note.module,          note.version,          note.toolchain,  note.abi_major,
          note.abi_minor_built, note.abi_minor_needed, note.build_flags};
}

Library load_library(const std::filesystem::path& path) {
  std::error_code ignored;
  Library library;
  library.path = std::filesystem::absolute(path, ignored).lexically_normal();
  library.note = inspect_library(library.path);
  const BreadcrumbScope crumb({library.path.c_str(), nullptr, "load", 0, -1});
  const Entry entry = open_entry(library.path);
  read_module(*call_entry(library.path, entry), library);
  return library;
}

}  // namespace pileus::host

#include "host/elf.hpp"

#include <elf.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace pileus::host {
namespace {

[[noreturn]] void refuse(const std::string& reason) {
  throw std::invalid_argument(reason);
}

/// Bytes whose every access is checked.
class Bytes {
 public:
  explicit Bytes(std::span<const std::byte> bytes) : bytes_(bytes) {}

  /// The `length` bytes at `offset`, named for the message when they are not all there.
  std::span<const std::byte> part(std::uint64_t offset, std::uint64_t length,
                                  const char* what) const {
    if (offset > bytes_.size() || length > bytes_.size() - offset) {
      refuse(std::string("is cut short or damaged: its ") + what + " lies beyond the end of file");
    }
    return bytes_.subspan(offset, length);
  }
  template <class T>
  T at(std::uint64_t offset, const char* what) const {
    T value;
    std::memcpy(&value, part(offset, sizeof(T), what).data(), sizeof(T));
    return value;
  }
  std::uint64_t size() const { return bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
};

#if defined(__x86_64__)
constexpr std::uint16_t this_machine = EM_X86_64;
#elif defined(__aarch64__)
constexpr std::uint16_t this_machine = EM_AARCH64;
#else
#error "the loader knows no ELF machine number for this architecture"
#endif

Elf64_Ehdr read_header(const Bytes& file) {
  if (file.size() < SELFMAG ||
      std::memcmp(file.part(0, SELFMAG, "header").data(), ELFMAG, SELFMAG) != 0) {
    refuse("is not an ELF file");
  }
  const auto header = file.at<Elf64_Ehdr>(0, "header");
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_ident[EI_DATA] != ELFDATA2LSB ||
      header.e_machine != this_machine) {
    refuse("is built for another machine");
  }
  if (header.e_type != ET_DYN) refuse("is an ELF file but not a shared library");
  if (header.e_shentsize != sizeof(Elf64_Shdr)) refuse("has no section table");
  return header;
}

std::vector<Elf64_Shdr> read_sections(const Bytes& file, const Elf64_Ehdr& header) {
  std::vector<Elf64_Shdr> sections;
  // The number is at most 65535, so the table's end cannot overflow.
  file.part(header.e_shoff, std::uint64_t{header.e_shnum} * sizeof(Elf64_Shdr), "section table");
  for (std::uint64_t i = 0; i < header.e_shnum; ++i) {
    sections.push_back(
        file.at<Elf64_Shdr>(header.e_shoff + i * sizeof(Elf64_Shdr), "section table"));
  }
  return sections;
}

/// The zero-terminated text at `offset` of a string section.
std::string text_at(const Bytes& file, const Elf64_Shdr& strings, std::uint64_t offset) {
  const auto all = file.part(strings.sh_offset, strings.sh_size, "string table");
  if (offset >= all.size()) refuse("is damaged: a name lies outside its string table");
  const char* begin = reinterpret_cast<const char*>(all.data()) + offset;
  return {begin, ::strnlen(begin, all.size() - offset)};
}

void read_note(const Bytes& file, const Elf64_Shdr& section, ElfFacts& facts) {
  if (section.sh_type == SHT_NOBITS) refuse("is damaged: its Pileus note has no contents");
  if (section.sh_size < sizeof(pileus_note)) refuse("is damaged: its Pileus note is too short");
  facts.note = file.at<pileus_note>(section.sh_offset, "Pileus note");
  facts.has_note = true;
  for (auto* text : {&facts.note.module, &facts.note.toolchain}) (*text)[63] = '\0';
  facts.note.version[31] = '\0';
}

void read_exports(const Bytes& file, const Elf64_Shdr& table, const Elf64_Shdr& strings,
                  ElfFacts& facts) {
  if (table.sh_entsize != sizeof(Elf64_Sym)) refuse("is damaged: odd size of dynamic symbols");
  file.part(table.sh_offset, table.sh_size, "dynamic symbol table");
  for (std::uint64_t i = 0; i < table.sh_size / sizeof(Elf64_Sym); ++i) {
    const auto symbol =
        file.at<Elf64_Sym>(table.sh_offset + i * sizeof(Elf64_Sym), "dynamic symbol table");
    const unsigned binding = ELF64_ST_BIND(symbol.st_info);
    const unsigned visibility = ELF64_ST_VISIBILITY(symbol.st_other);
    const bool defined = symbol.st_shndx != SHN_UNDEF;
    const bool bindable =
        binding != STB_LOCAL && (visibility == STV_DEFAULT || visibility == STV_PROTECTED);
    if (defined && bindable) facts.exports.push_back(text_at(file, strings, symbol.st_name));
    if (!defined && binding == STB_GLOBAL)
      facts.undefined.push_back(text_at(file, strings, symbol.st_name));
  }
}

void read_dynamic(const Bytes& file, const Elf64_Shdr& table, const Elf64_Shdr& strings,
                  ElfFacts& facts) {
  file.part(table.sh_offset, table.sh_size, "dynamic section");
  for (std::uint64_t i = 0; i < table.sh_size / sizeof(Elf64_Dyn); ++i) {
    const auto entry =
        file.at<Elf64_Dyn>(table.sh_offset + i * sizeof(Elf64_Dyn), "dynamic section");
    if (entry.d_tag == DT_NULL) return;
    if (entry.d_tag == DT_NEEDED) facts.needed.push_back(text_at(file, strings, entry.d_un.d_val));
    if (entry.d_tag == DT_TEXTREL ||
        (entry.d_tag == DT_FLAGS && (entry.d_un.d_val & DF_TEXTREL) != 0))
      facts.has_text_relocations = true;
  }
}

/// A file mapped for reading, unmapped at the end of its scope.
class MappedFile {
 public:
  explicit MappedFile(const std::filesystem::path& path) {
    // Without waiting: a pipe in a folder of plugins would otherwise hold the program for good.
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) refuse(std::string("cannot be read: ") + std::strerror(errno));
    struct stat status {};
    const bool regular = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
    if (regular && status.st_size > 0) {
      size_ = static_cast<std::size_t>(status.st_size);
      data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0);
    }
    ::close(descriptor);
    if (!regular) refuse("cannot be read: it is not a regular file");
    if (data_ == MAP_FAILED) refuse(std::string("cannot be read: ") + std::strerror(errno));
  }
  ~MappedFile() {
    if (data_ != nullptr) ::munmap(data_, size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace

ElfFacts parse_elf(std::span<const std::byte> bytes) {
  const Bytes file(bytes);
  const Elf64_Ehdr header = read_header(file);
  const std::vector<Elf64_Shdr> sections = read_sections(file, header);
  if (header.e_shstrndx >= sections.size()) refuse("has no section names");
  ElfFacts facts;
  for (const Elf64_Shdr& section : sections) {
    if (section.sh_type == SHT_DYNSYM) {
      if (section.sh_link >= sections.size()) refuse("is damaged: symbols without names");
      read_exports(file, section, sections[section.sh_link], facts);
    } else if (section.sh_type == SHT_DYNAMIC) {
      if (section.sh_link >= sections.size()) refuse("is damaged: libraries without names");
      read_dynamic(file, section, sections[section.sh_link], facts);
    } else if (!facts.has_note && section.sh_type != SHT_NULL &&
               text_at(file, sections[header.e_shstrndx], section.sh_name) == PILEUS_NOTE_SECTION) {
      read_note(file, section, facts);
    }
  }
  return facts;
}

ElfFacts read_elf(const std::filesystem::path& path) {
  return parse_elf(MappedFile(path).bytes());
}

}  // namespace pileus::host

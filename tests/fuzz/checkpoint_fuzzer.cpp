// Any bytes may be found in place of a checkpoint, and any names and numbers in one.
//
// The first byte chooses: even, the rest is the file; odd, the rest says what goes into a
// checkpoint, which is written and must be read back as it was, or be refused by a store of another
// form. Damage inside a sealed file is not tried: the seal is what keeps HDF5 from such files.
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/error.hpp"
#include "output/checkpoint.hpp"

namespace {

namespace fs = std::filesystem;
using pileus::output::Checkpoint;
using pileus::parcels::Store;

/// A folder of this process; in memory where there is such a place.
const fs::path& folder() {
  static const fs::path path = [] {
    const fs::path parent = fs::is_directory("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
    std::string pattern = (parent / "pileus-fuzz-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) std::abort();
    std::atexit([] { fs::remove_all(folder()); });
    return fs::path(pattern);
  }();
  return path;
}

/// Takes numbers and texts from the bytes until none are left; then zeros.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : at_(data), left_(size) {}
  std::uint8_t byte() { return left_ == 0 ? std::uint8_t{0} : (--left_, *at_++); }
  double number() {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  /// 1 to 8 characters, none of them NUL.
  std::string name() {
    std::string text;
    for (int length = 1 + byte() % 8; length > 0; --length)
      text += static_cast<char>(1 + byte() % 255);
    return text;
  }
  bool empty() const { return left_ == 0; }

 private:
  const std::uint8_t* at_;
  std::size_t left_;
};

Store make_store(int kind) {
  using enum pileus::parcels::Nature;
  std::vector<pileus::parcels::Scalar> scalars;
  if ((kind & 1) != 0) scalars.push_back({"buoyancy", "m s-2", intensive, "", 0, 0, 0});
  return {(kind & 2) != 0 ? 2 : 3, scalars};
}

void read_raw(const std::uint8_t* data, std::size_t size) {
  const fs::path path = folder() / "checkpoint_000000000001.h5";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  Store store = make_store(1);
  try {
    pileus::output::read_checkpoint(path, store);
  } catch (const pileus::Error&) {
    // damaged, in words
  }
  if (pileus::output::find_newest_valid_checkpoint(folder()) == path &&
      size < 48)  // shorter than any seal
    __builtin_trap();
}

Checkpoint make_checkpoint(Bytes& bytes) {
  Checkpoint checkpoint;
  checkpoint.time = bytes.number();
  checkpoint.dt = bytes.number();
  checkpoint.step = bytes.byte();
  for (int entries = 0; entries < 8 && !bytes.empty(); ++entries) {
    const std::string name = bytes.name();
    switch (bytes.byte() % 4) {
      case 0:
        checkpoint.data.arrays[name].assign(bytes.byte() % 16, bytes.number());
        break;
      case 1:
        checkpoint.data.counters[name].assign(bytes.byte() % 16, bytes.byte());
        break;
      case 2:
        checkpoint.data.bytes[name].assign(bytes.byte() % 16, bytes.byte());
        break;
      default:
        checkpoint.data.texts[name] = bytes.name();
    }
  }
  return checkpoint;
}

/// Equal to the bit: values that are not numbers too.
bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

bool same(const Checkpoint& a, const Checkpoint& b) {
  bool equal = a.step == b.step && same_bits({a.time, a.dt}, {b.time, b.dt}) &&
               a.data.counters == b.data.counters && a.data.bytes == b.data.bytes &&
               a.data.texts == b.data.texts && a.data.arrays.size() == b.data.arrays.size();
  for (const auto& [name, values] : a.data.arrays) {
    const auto found = b.data.arrays.find(name);
    equal = equal && found != b.data.arrays.end() && same_bits(values, found->second);
  }
  return equal;
}

void write_and_read(Bytes bytes) {
  const int written_kind = bytes.byte() & 3, read_kind = bytes.byte() & 3;
  Store store = make_store(written_kind);
  store.resize(bytes.byte() % 5);
  for (std::size_t p = 0; p < store.size(); ++p) {
    store.uid()[p] = p + 1;
    for (int c = 0; c < store.state_columns(); ++c) store.column(c)[p] = bytes.number();
  }
  const Checkpoint checkpoint = make_checkpoint(bytes);
  const fs::path path = pileus::output::write_checkpoint(folder(), store, checkpoint, 1);
  Store other = make_store(read_kind);
  try {
    const Checkpoint found = pileus::output::read_checkpoint(path, other);
    if (written_kind != read_kind || !same(checkpoint, found) || other.size() != store.size())
      __builtin_trap();
    for (int c = 0; c < store.state_columns(); ++c)
      if (store.size() > 0 &&
          std::memcmp(store.column(c), other.column(c), store.size() * sizeof(double)) != 0)
        __builtin_trap();
  } catch (const pileus::Error&) {
    if (written_kind == read_kind) __builtin_trap();
  }
  fs::remove(path);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  if (data[0] % 2 == 0)
    read_raw(data + 1, size - 1);
  else
    write_and_read(Bytes(data + 1, size - 1));
  return 0;
}

#include "output/hdf5_driver.hpp"

#include <functional>

namespace pileus::output {

namespace {

/// What the property list carries.
struct DriverInfo {
  StagedFile* file;
};

/// One open of a file; HDF5 keeps its own part first.
struct OpenFile {
  H5FD_t pub;
  StagedFile* file;
  haddr_t end_of_allocation;
};

OpenFile& self(H5FD_t* file) {
  return *reinterpret_cast<OpenFile*>(file);
}
const OpenFile& self(const H5FD_t* file) {
  return *reinterpret_cast<const OpenFile*>(file);
}

H5FD_t* open_file(const char*, unsigned, hid_t access_list, haddr_t) {
  const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access_list));
  if (info == nullptr) return nullptr;
  return &(new OpenFile{{}, info->file, 0})->pub;
}

herr_t close_file(H5FD_t* file) {
  delete &self(file);
  return 0;
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  const std::less<const StagedFile*> before;
  if (before(self(a).file, self(b).file)) return -1;
  return before(self(b).file, self(a).file) ? 1 : 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  if (flags != nullptr)
    // No accumulation of metadata: it would hide what kind of object is written.
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t get_eoa(const H5FD_t* file, H5FD_mem_t) {
  return self(file).end_of_allocation;
}

herr_t set_eoa(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  self(file).end_of_allocation = address;
  return 0;
}

haddr_t get_eof(const H5FD_t* file, H5FD_mem_t) {
  return self(file).file->size();
}

herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t bytes, void* buffer) {
  return self(file).file->read(address, bytes, buffer) ? 0 : -1;
}

/// Object headers hold the extents, which lead readers to everything else. The superblock, with the
/// end of the file, has to be new before them.
StagedFile::Role role_of(H5FD_mem_t type) {
  if (type == H5FD_MEM_DRAW) return StagedFile::Role::data;
  return type == H5FD_MEM_OHDR ? StagedFile::Role::header : StagedFile::Role::index;
}

herr_t write(H5FD_t* file, H5FD_mem_t type, hid_t, haddr_t address, size_t bytes,
             const void* buffer) {
  self(file).file->write(address, bytes, buffer, role_of(type));
  return 0;
}

herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
  OpenFile& open = self(file);
  if (open.file->mode() != StagedFile::Mode::read && open.end_of_allocation != open.file->size())
    open.file->truncate(open.end_of_allocation);
  return 0;
}

H5FD_class_t driver_class() {
  H5FD_class_t driver{};
#if H5_VERSION_GE(1, 13, 0)
  driver.version = H5FD_CLASS_VERSION;
  driver.value = static_cast<H5FD_class_value_t>(H5_VFD_RESERVED + 71);
#endif
  driver.name = "pileus_staged";
  driver.maxaddr = ~haddr_t{0} >> 1;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.fapl_size = sizeof(DriverInfo);
  driver.open = open_file;
  driver.close = close_file;
  driver.cmp = compare;
  driver.query = query;
  driver.get_eoa = get_eoa;
  driver.set_eoa = set_eoa;
  driver.get_eof = get_eof;
  driver.read = read;
  driver.write = write;
  driver.truncate = truncate;
  constexpr H5FD_mem_t map[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
  for (int type = 0; type < H5FD_MEM_NTYPES; ++type) driver.fl_map[type] = map[type];
  return driver;
}

}  // namespace

herr_t set_staged_driver(hid_t access_list, StagedFile& file) {
  static const H5FD_class_t driver = driver_class();
  static const hid_t driver_id = H5FDregister(&driver);
  const DriverInfo info{&file};
  return H5Pset_driver(access_list, driver_id, &info);
}

}  // namespace pileus::output

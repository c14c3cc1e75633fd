// HDF5 on top of StagedFile: a virtual file driver.
#pragma once
#include <hdf5.h>

#include "output/staged_file.hpp"

namespace pileus::output {

/// Makes a file-access property list send all reads and writes to `file`, which has to outlive
/// every HDF5 file opened with it. Returns a negative value when HDF5 refuses.
herr_t set_staged_driver(hid_t access_list, StagedFile& file);

}  // namespace pileus::output

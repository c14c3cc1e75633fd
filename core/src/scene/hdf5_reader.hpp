// Reading variables, coordinates and text attributes of HDF5 files; throws plain sentences.
#pragma once
#include <hdf5.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace pileus::scene {

/// The file is missing, cut short or unreadable.
struct UnreadableFile : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The file is readable but not what was asked for.
struct WrongContent : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One axis of a variable as its dimension scale states it; empty when there is none.
struct FileAxis {
  std::string name;
  std::vector<double> points;
  std::string units;
};

/// An open HDF5 file.
class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::string& path);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  /// Opens a variable; throws WrongContent naming the nearest variable.
  void open(const std::string& variable);

  const std::vector<hsize_t>& shape() const { return shape_; }
  /// The last record of a variable with `rank` dimensions beside time, x fastest, unpacked
  /// (scale_factor, add_offset).
  std::vector<double> last_record(std::size_t rank) const;
  FileAxis axis(std::size_t dimension) const;
  /// A text attribute of the variable, or empty.
  std::string attribute(const char* name) const;

 private:
  std::vector<std::string> variable_names() const;

  std::string path_;
  hid_t file_ = -1, dataset_ = -1;
  std::vector<hsize_t> shape_;
};

}  // namespace pileus::scene

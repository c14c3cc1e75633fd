// Quantities of the ground under the parcels: one number per column of cells, kept by the core.
#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pileus::coupling {

/// A declared quantity of the place "surface".
struct SurfaceQuantity {
  std::string name, units;  // registered, SI
  double initial = 0;       // in every column at the start of a run
};

/// The surface quantities of a run. Element x + n_x·y of a field belongs to the column of cells
/// (x, y); a plane run has n_y = 1.
class SurfaceFields {
 public:
  SurfaceFields() = default;
  explicit SurfaceFields(std::vector<SurfaceQuantity> list)
      : list_(std::move(list)), values_(list_.size()), given_(list_.size()) {}

  const std::vector<SurfaceQuantity>& list() const { return list_; }
  bool empty() const { return list_.empty(); }
  std::size_t columns() const { return columns_; }
  /// Position in list() or −1.
  int find(std::string_view name) const;

  /// Makes room for `columns` values per quantity and gives them their initial values.
  void start(std::size_t columns);
  /// The initial values of one quantity, column by column, for every start from now on.
  void begin_with(std::size_t field, std::vector<double> values) {
    given_[field] = std::move(values);
  }

  std::vector<double>& values(std::size_t field) { return values_[field]; }
  const std::vector<double>& values(std::size_t field) const { return values_[field]; }

  /// All values as "surface/<name>", for checkpoints and digests; and back, after start().
  /// Errors  Error(ExitCode::usage) if the values of a quantity are missing or too many or too few
  std::map<std::string, std::vector<double>> named_values() const;
  void restore(const std::map<std::string, std::vector<double>>& named);

 private:
  std::vector<SurfaceQuantity> list_;
  std::vector<std::vector<double>> values_;
  std::vector<std::vector<double>> given_;  // what values start with; empty: the declared value
  std::size_t columns_ = 0;
};

}  // namespace pileus::coupling

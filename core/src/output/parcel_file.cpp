#include "output/parcel_file.hpp"

#include <stdexcept>
#include <utility>

namespace pileus::output {
namespace {

const double* column_of(const parcels::Store& store, const std::string& name) {
  for (int column = 0; column < store.column_count(); ++column)
    if (store.column_name(column) == name) return store.column(column);
  throw std::invalid_argument("parcels have no column " + name);
}

}  // namespace

ParcelFile::ParcelFile(std::filesystem::path path, int dimension, std::vector<Variable> columns,
                       Provenance provenance, Encoding encoding, Start start)
    : RaggedFile(std::move(path),
                 {"parcels",
                  "number of parcels of the record",
                  {{"uid", "1", "identity of the parcel"}},
                  position_variables(dimension, "the parcel's centre"),
                  std::move(columns)},
                 std::move(provenance), encoding, start) {}

void ParcelFile::append(double time, const parcels::Store& store) {
  RaggedRecord record;
  record.size = store.size();
  record.wholes = {store.uid()};
  for (const Variable& variable : content().positions)
    record.positions.push_back(column_of(store, variable.name));
  for (const Variable& variable : content().columns)
    record.columns.push_back(column_of(store, variable.name));
  RaggedFile::append(time, record);
}

}  // namespace pileus::output

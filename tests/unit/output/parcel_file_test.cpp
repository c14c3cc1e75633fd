#include "output/parcel_file.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "sample_store.hpp"
#include "support.hpp"

namespace pileus::output {
namespace {

std::vector<Variable> columns() {
  return {{"buoyancy", "m s-2", "buoyancy"}, {"volume", "m3", "volume"}};
}

parcels::Store store_of(std::size_t size, std::uint64_t seed, int dimension = 3) {
  parcels::Store store(dimension, sample_scalars());
  store.resize(size);
  fill_with_numbers(store, seed);
  return store;
}

ParcelFile parcel_file(const std::filesystem::path& path, Start start = Start::fresh()) {
  return ParcelFile(path, 3, columns(), sample_provenance(), {.exact = true}, start);
}

std::vector<double> stored(const std::filesystem::path& path, const std::string& name) {
  const hdf5::Session session = hdf5::Session::read(path);
  return hdf5::read_array<double>(session, session.file(), "parcels/" + name);
}

TEST(ParcelFile, ragged_records_come_back_bit_for_bit) {
  const ScratchFolder folder;
  ParcelFile file = parcel_file(folder / "parcels.nc");
  std::vector<double> expected;
  std::vector<std::uint64_t> uids;
  // 40 000 crosses a chunk of the file, 0 is a record without parcels.
  for (const std::size_t size : {5, 0, 40000, 1}) {
    const parcels::Store store = store_of(size, 7 + size);
    file.append(static_cast<double>(file.times().size()), store);
    const double* buoyancy = store.scalar(store.find_scalar("buoyancy"));
    expected.insert(expected.end(), buoyancy, buoyancy + size);
    uids.insert(uids.end(), store.uid(), store.uid() + size);
  }
  EXPECT_EQ(stored(folder / "parcels.nc", "buoyancy"), expected);
  EXPECT_EQ(stored(folder / "parcels.nc", "row_size"), (std::vector<double>{5, 0, 40000, 1}));
  const hdf5::Session session = hdf5::Session::read(folder / "parcels.nc");
  EXPECT_EQ(hdf5::read_array<std::uint64_t>(session, session.file(), "parcels/uid"), uids);
}

TEST(ParcelFile, xarray_and_ncdump_read_the_group) {
  const ScratchFolder folder;
  ParcelFile file = parcel_file(folder / "parcels.nc");
  file.append(0, store_of(4, 1));
  file.append(30, store_of(6, 2));
  const CommandResult header = run_command("ncdump -h '" + (folder / "parcels.nc").string() + "'");
  for (const char* line : {"group: parcels {", "obs = UNLIMITED ; // (10 currently)",
                           "time = UNLIMITED ; // (2 currently)", "int64 row_size(time) ;",
                           "row_size:sample_dimension = \"obs\" ;", "uint64 uid(obs) ;",
                           "double x_position(obs) ;", "x_position:units = \"m\" ;"})
    EXPECT_NE(header.text.find(line), std::string::npos) << line << "\n" << header.text;
  const CommandResult result = run_python(folder, R"py(
import sys, xarray, numpy
for engine in ("netcdf4", "h5netcdf"):
    with xarray.open_dataset(sys.argv[1], group="parcels", engine=engine) as d:
        assert list(d.row_size.values) == [4, 6]
        assert d.buoyancy.dims == ("obs",) and d.buoyancy.shape == (10,)
        assert d.uid.dtype == numpy.uint64 and len(set(d.uid.values)) == 10
        assert d.time[1] - d.time[0] == numpy.timedelta64(30, "s")
        start = numpy.cumsum(d.row_size.values) - d.row_size.values
        assert d.isel(obs=slice(start[1], start[1] + 6)).x_position.size == 6
    with xarray.open_dataset(sys.argv[1], engine=engine) as d:
        assert d.attrs["Conventions"] == "CF-1.10"
)py",
                                          {folder / "parcels.nc"});
  EXPECT_EQ(result.status, 0) << result.text;
}

TEST(ParcelFile, resuming_removes_later_records) {
  const ScratchFolder folder;
  ParcelFile whole = parcel_file(folder / "whole.nc");
  for (int n = 0; n < 5; ++n) whole.append(n, store_of(10 + n, n));
  {
    ParcelFile part = parcel_file(folder / "part.nc");
    for (int n = 0; n < 4; ++n) part.append(n, store_of(10 + n, n));
    part.append(4.5, store_of(99, 99));  // of the future the checkpoint does not know
  }
  ParcelFile resumed = parcel_file(folder / "part.nc", Start::resume_at(2));
  EXPECT_EQ(resumed.times(), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(resumed.row_sizes(), (std::vector<std::uint64_t>{10, 11, 12}));
  for (int n = 3; n < 5; ++n) resumed.append(n, store_of(10 + n, n));
  for (const char* name : {"time", "row_size", "uid", "x_position", "z_position", "volume"})
    EXPECT_EQ(stored(folder / "part.nc", name), stored(folder / "whole.nc", name)) << name;
  std::string sidecar = bytes_of(folder / "part.xmf");
  for (std::size_t at; (at = sidecar.find("part.nc")) != std::string::npos;)
    sidecar.replace(at, 7, "whole.nc");
  EXPECT_EQ(sidecar, bytes_of(folder / "whole.xmf"));
}

TEST(ParcelFile, missing_column_is_refused_and_nothing_written) {
  const ScratchFolder folder;
  ParcelFile file(folder / "parcels.nc", 3, {{"snow", "1", "snow"}}, sample_provenance(), {},
                  Start::fresh());
  EXPECT_THROW(file.append(0, store_of(3, 1)), std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ParcelFile, sidecar_describes_the_arrays_of_the_file) {
  for (const int dimension : {2, 3}) {
    const ScratchFolder folder;
    ParcelFile file(folder / "parcels.nc", dimension, columns(), sample_provenance(), {},
                    Start::fresh());
    for (int n = 0; n < 3; ++n) file.append(10 * n, store_of(4 + n, n, dimension));
    const CommandResult result = run_python(folder, R"py(
import sys, os, h5py, xml.etree.ElementTree as xml
dimension = int(sys.argv[2])
folder = os.path.dirname(sys.argv[1])
grids = xml.parse(sys.argv[1]).getroot().findall("./Domain/Grid/Grid")
assert [float(g.find("Time").get("Value")) for g in grids] == [0, 10, 20]
first = 0
for n, grid in enumerate(grids):
    assert grid.find("Topology").get("NumberOfElements") == str(4 + n)
    names = []
    for slab in grid.iter("DataItem"):
        if slab.get("ItemType") != "HyperSlab": continue
        selection, source = slab.findall("DataItem")
        assert [int(i) for i in selection.text.split()] == [first, 1, 4 + n]
        name, path = source.text.split(":")
        with h5py.File(os.path.join(folder, name)) as f:
            assert str(f[path].shape[0]) == source.get("Dimensions")
            assert f[path].dtype.itemsize == int(source.get("Precision"))
        names.append(path.split("/")[-1])
    axes = ["x", "y", "z"] if dimension == 3 else ["x", "z"]
    assert names == [a + "_position" for a in axes] + ["buoyancy", "volume"], names
    first += 4 + n
)py",
                                            {folder / "parcels.xmf", std::to_string(dimension)});
    EXPECT_EQ(result.status, 0) << result.text;
  }
}

}  // namespace
}  // namespace pileus::output

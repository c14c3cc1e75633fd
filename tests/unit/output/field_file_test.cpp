#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/error.hpp"
#include "output/field_file.hpp"
#include "output/grid_fields.hpp"
#include "support.hpp"

namespace pileus::output {
namespace {

const mesh::Grid<3> grid3({4, 3, 5}, {0, -1, 10}, {8, 6, 20});

std::vector<Variable> two_variables() {
  return {{"buoyancy", "m s-2", "buoyancy", ""},
          {"w", "m s-1", "vertical velocity", "upward_air_velocity"}};
}

std::vector<std::vector<double>> random_record(std::size_t variables, std::size_t size,
                                               std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<std::vector<double>> values(variables, std::vector<double>(size));
  for (auto& field : values)
    for (double& value : field) value = uniform(random);
  return values;
}

FieldFile field_file(const std::filesystem::path& path, Start start = Start::fresh(),
                     Encoding encoding = {}) {
  return FieldFile(path, node_axes(grid3), two_variables(), sample_provenance(), encoding, start);
}

std::size_t field_size() {
  return 4 * 3 * 6;
}

std::vector<double> stored(const std::filesystem::path& path, const std::string& name) {
  const hdf5::Session session = hdf5::Session::read(path);
  return hdf5::read_array<double>(session, session.file(), name);
}

TEST(FieldFile, ExactValuesComeBackBitForBit) {
  const ScratchFolder folder;
  FieldFile file = field_file(folder / "fields.nc", Start::fresh(), {.exact = true});
  const auto first = random_record(2, field_size(), 1), second = random_record(2, field_size(), 2);
  file.append(0.0, first);
  file.append(0.1, second);
  for (std::size_t v = 0; v < 2; ++v) {
    std::vector<double> expected = first[v];
    expected.insert(expected.end(), second[v].begin(), second[v].end());
    EXPECT_EQ(stored(folder / "fields.nc", two_variables()[v].name), expected);
  }
  EXPECT_EQ(stored(folder / "fields.nc", "time"), (std::vector<double>{0.0, 0.1}));
}

TEST(FieldFile, DefaultIsFloat32) {
  const ScratchFolder folder;
  FieldFile file = field_file(folder / "fields.nc");
  const auto values = random_record(2, field_size(), 3);
  file.append(0.0, values);
  const std::vector<double> back = stored(folder / "fields.nc", "w");
  ASSERT_EQ(back.size(), values[1].size());
  for (std::size_t i = 0; i < back.size(); ++i)
    EXPECT_EQ(back[i], static_cast<double>(static_cast<float>(values[1][i])));
}

TEST(FieldFile, NodesAreWrittenWithZSlowest) {
  constexpr int width = 8, component = 4;
  std::vector<double> nodes(grid3.nodes() * width, NAN), values;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k <= 5; ++k)
        nodes[grid3.node(grid3.column(i, j), k) * width + component] = 100 * k + 10 * j + i;
  copy_nodes(grid3, nodes.data(), width, component, values);
  ASSERT_EQ(values.size(), field_size());
  for (int k = 0; k <= 5; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 4; ++i)
        EXPECT_EQ(values[static_cast<std::size_t>((k * 3 + j) * 4 + i)], 100 * k + 10 * j + i);
}

TEST(FieldFile, NcdumpReadsTheHeader) {
  const ScratchFolder folder;
  FieldFile file = field_file(folder / "fields.nc", Start::fresh(), {.mantissa_bits = 12});
  file.append(0.0, random_record(2, field_size(), 4));
  file.append(60.0, random_record(2, field_size(), 5));
  const CommandResult result = run_command("ncdump -hs '" + (folder / "fields.nc").string() + "'");
  ASSERT_EQ(result.status, 0) << result.text;
  for (const char* line :
       {"time = UNLIMITED ; // (2 currently)", "z = 6 ;", "y = 3 ;", "x = 4 ;",
        "double time(time) ;", "float buoyancy(time, z, y, x) ;", "buoyancy:units = \"m s-2\" ;",
        "w:standard_name = \"upward_air_velocity\" ;",
        "buoyancy:_QuantizeBitRoundNumberOfSignificantBits = 12 ;", "z:positive = \"up\" ;",
        "time:units = \"seconds since 2000-01-01 00:00:00\" ;", "string scene ;",
        ":Conventions = \"CF-1.10\" ;", ":seed_initial = 18446744073709551615ULL ;",
        ":_Format = \"netCDF-4\" ;"})
    EXPECT_NE(result.text.find(line), std::string::npos) << line << "\n" << result.text;
  EXPECT_EQ(result.text.find("buoyancy:standard_name"), std::string::npos);
  EXPECT_EQ(result.text.find("x:axis"), std::string::npos);
}

TEST(FieldFile, XarrayOpensItWithBothEngines) {
  const ScratchFolder folder;
  FieldFile file = field_file(folder / "fields.nc");
  std::vector<std::vector<double>> values(2, std::vector<double>(field_size()));
  for (std::size_t i = 0; i < field_size(); ++i) values[1][i] = static_cast<double>(i);
  file.append(0.0, values);
  file.append(90.5, values);
  const CommandResult result = run_python(folder, R"py(
import sys, xarray, numpy
for engine in ("netcdf4", "h5netcdf"):
    with xarray.open_dataset(sys.argv[1], engine=engine) as d:
        assert d.w.dims == ("time", "z", "y", "x"), d.w.dims
        assert d.w.shape == (2, 6, 3, 4), d.w.shape
        assert d.w.dtype == numpy.float32
        assert d.w[1, 2, 1, 3] == (2 * 3 + 1) * 4 + 3
        assert d.time[1] - d.time[0] == numpy.timedelta64(90500, "ms")
        assert list(d.x.values) == [0, 2, 4, 6] and list(d.z.values) == [10, 14, 18, 22, 26, 30]
        assert d.z.attrs["units"] == "m"
        assert str(d.scene.values[()]).startswith("name: thermal\n")
        assert d.attrs["source"] == "Pileus 0.0.0 (commit abc)"
        assert int(d.attrs["seed_initial"]) == 18446744073709551615
)py",
                                          {folder / "fields.nc"});
  EXPECT_EQ(result.status, 0) << result.text;
}

TEST(FieldFile, NetcdfLibraryCanAppend) {
  const ScratchFolder folder;
  FieldFile file = field_file(folder / "fields.nc");
  file.append(0.0, random_record(2, field_size(), 6));
  const CommandResult result = run_python(folder, R"py(
import sys, netCDF4
with netCDF4.Dataset(sys.argv[1], "a") as d:
    d["time"][1] = 60.0
    d["w"][1] = 3.0
    d.createVariable("extra", "f4", ("time", "z"))
)py",
                                          {folder / "fields.nc"});
  EXPECT_EQ(result.status, 0) << result.text;
  EXPECT_THROW(file.append(120.0, random_record(2, field_size(), 7)), Error)
      << "a record that another program added has to be noticed";
}

TEST(FieldFile, TwoDimensionalFieldsHaveNoY) {
  const ScratchFolder folder;
  const mesh::Grid<2> grid({4, 5}, {0, 0}, {8, 20});
  FieldFile file(folder / "fields.nc", node_axes(grid), two_variables(), sample_provenance(), {},
                 Start::fresh());
  file.append(0.0, random_record(2, 4 * 6, 8));
  const CommandResult result = run_command("ncdump -h '" + (folder / "fields.nc").string() + "'");
  EXPECT_NE(result.text.find("float w(time, z, x) ;"), std::string::npos) << result.text;
}

TEST(FieldFile, RefusesToOverwriteUnlessTold) {
  const ScratchFolder folder;
  {
    FieldFile file = field_file(folder / "fields.nc");
    file.append(0.0, random_record(2, field_size(), 9));
  }
  const std::string before = bytes_of(folder / "fields.nc");
  try {
    field_file(folder / "fields.nc");
    FAIL() << "overwriting was allowed";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::file);
    EXPECT_NE(std::string(error.what()).find("fields.nc"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("--force"), std::string::npos);
  }
  FieldFile file = field_file(folder / "fields.nc", Start::overwrite());
  EXPECT_EQ(bytes_of(folder / "fields.nc"), before) << "touched before the first record";
  file.append(5.0, random_record(2, field_size(), 10));
  EXPECT_EQ(stored(folder / "fields.nc", "time"), std::vector<double>{5.0});
}

TEST(FieldFile, EqualRunsGiveEqualBytes) {
  const ScratchFolder folder;
  for (const char* name : {"a.nc", "b.nc"}) {
    FieldFile file = field_file(folder / name);
    for (int n = 0; n < 3; ++n) file.append(n, random_record(2, field_size(), 20u + n));
  }
  EXPECT_EQ(bytes_of(folder / "a.nc"), bytes_of(folder / "b.nc"));
}

TEST(FieldFile, RecordsHaveToFollowOneAnother) {
  const ScratchFolder folder;
  FieldFile file = field_file(folder / "fields.nc");
  file.append(1.0, random_record(2, field_size(), 11));
  EXPECT_THROW(file.append(1.0, random_record(2, field_size(), 12)), std::invalid_argument);
  EXPECT_THROW(file.append(2.0, random_record(1, field_size(), 12)), std::invalid_argument);
  EXPECT_THROW(file.append(2.0, random_record(2, field_size() + 1, 12)), std::invalid_argument);
}

TEST(FieldFile, UnwritableFolderIsNamedWithTheReason) {
  const ScratchFolder folder;
  FieldFile file = field_file(folder / "missing/fields.nc");
  try {
    file.append(0.0, random_record(2, field_size(), 13));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::file);
    const std::string message = error.what();
    EXPECT_NE(message.find("fields.nc"), std::string::npos) << message;
    EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
  }
}

TEST(FieldFile, SomethingElseUnderItsNameIsNamed) {
  const ScratchFolder folder;
  std::ofstream(folder / "fields.nc") << "not HDF5 at all";
  try {
    field_file(folder / "fields.nc", Start::resume_at(0));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("cannot open as HDF5"), std::string::npos)
        << error.what();
  }
}

TEST(FieldFile, SidecarDescribesTheArraysOfTheFile) {
  const ScratchFolder folder;
  const mesh::Grid<2> flat({4, 5}, {100, 0}, {8, 20});
  FieldFile solid = field_file(folder / "3.nc");
  FieldFile plane(folder / "2.nc", node_axes(flat), two_variables(), sample_provenance(),
                  {.exact = true}, Start::fresh());
  for (int n = 0; n < 3; ++n) {
    solid.append(10 * n, random_record(2, field_size(), 30u + n));
    plane.append(10 * n, random_record(2, 4 * 6, 40u + n));
  }
  const CommandResult result = run_python(folder, R"py(
import sys, os, h5py, xml.etree.ElementTree as xml
numbers = lambda text: [float(n) for n in text.split()]
expected = {"3.xmf": ("6 3 4", [10, -1, 0], [4, 2, 2]), "2.xmf": ("1 6 4", [0, 0, 100], [1, 4, 2])}
for sidecar in sys.argv[1:]:
    shape, origin, spacing = expected[os.path.basename(sidecar)]
    grids = xml.parse(sidecar).getroot().findall("./Domain/Grid/Grid")
    assert [float(g.find("Time").get("Value")) for g in grids] == [0, 10, 20]
    for n, grid in enumerate(grids):
        assert grid.find("Topology").get("Dimensions") == shape
        assert [numbers(i.text) for i in grid.findall("Geometry/DataItem")] == [origin, spacing]
        for slab in grid.findall("Attribute/DataItem"):
            selection, source = slab.findall("DataItem")
            rank = int(selection.get("Dimensions").split()[1])
            start, stride, count = (numbers(selection.text)[k * rank:][:rank] for k in range(3))
            name, path = source.text.split(":")
            with h5py.File(os.path.join(os.path.dirname(sidecar), name)) as f:
                assert list(f[path].shape) == numbers(source.get("Dimensions"))
                assert f[path].dtype.itemsize == int(source.get("Precision"))
                assert start == [n] + [0] * (f[path].ndim - 1) and set(stride) == {1}
                assert count == [1] + list(f[path].shape[1:])
)py",
                                          {folder / "3.xmf", folder / "2.xmf"});
  EXPECT_EQ(result.status, 0) << result.text;
}

}  // namespace
}  // namespace pileus::output

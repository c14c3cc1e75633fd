#include "output/record_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "output/field_file.hpp"
#include "support.hpp"

namespace pileus::output {
namespace {

std::vector<double> stored(const std::filesystem::path& path, const std::string& name) {
  const hdf5::Session session = hdf5::Session::read(path);
  return hdf5::read_array<double>(session, session.file(), name);
}

Axis heights(std::size_t count) {
  Axis axis{{"z", "m", "height"}, {}, "up"};
  for (std::size_t k = 0; k < count; ++k) axis.values.push_back(10.0 * static_cast<double>(k));
  return axis;
}

SeriesFile series_file(const std::filesystem::path& path, Start start = Start::fresh()) {
  return SeriesFile(path, {{"energy", "m2 s-2", "energy"}, {"volume", "m3", "volume"}},
                    sample_provenance(), start);
}

TEST(SeriesFile, keeps_every_bit_of_one_record_or_many) {
  const ScratchFolder folder;
  SeriesFile file = series_file(folder / "series.nc");
  const double tiny = std::numeric_limits<double>::denorm_min();
  file.append(0, std::vector<double>{1.0 / 3, tiny});
  const std::vector<double> times = {0.1, 0.2, 0.3};
  const std::vector<std::vector<double>> block = {{1, 2, 3}, {-0.0, 1e308, M_PI}};
  file.append_records(times, block);
  EXPECT_EQ(stored(folder / "series.nc", "time"), (std::vector<double>{0, 0.1, 0.2, 0.3}));
  EXPECT_EQ(stored(folder / "series.nc", "energy"), (std::vector<double>{1.0 / 3, 1, 2, 3}));
  EXPECT_EQ(stored(folder / "series.nc", "volume"), (std::vector<double>{tiny, -0.0, 1e308, M_PI}));
}

TEST(SeriesFile, xarray_shows_one_dimension) {
  const ScratchFolder folder;
  SeriesFile file = series_file(folder / "series.nc");
  for (int n = 0; n < 700; ++n) file.append(n, std::vector<double>{1.0 * n, 2.0 * n});
  const CommandResult result = run_python(folder, R"py(
import sys, xarray
for engine in ("netcdf4", "h5netcdf"):
    with xarray.open_dataset(sys.argv[1], engine=engine, decode_times=False) as d:
        assert dict(d.sizes) == {"time": 700}
        assert (d.volume == 2 * d.time).all() and d.volume.attrs["units"] == "m3"
)py",
                                          {folder / "series.nc"});
  EXPECT_EQ(result.status, 0) << result.text;
  // 700 records of three numbers fill 17 kB; appending one by one must not leave dead space.
  EXPECT_LT(std::filesystem::file_size(folder / "series.nc"), 64u << 10);
}

TEST(ProfileFile, is_over_time_and_height) {
  const ScratchFolder folder;
  ProfileFile file(folder / "profiles.nc", heights(5), {{"wind", "m s-1", "wind"}},
                   sample_provenance(), Start::fresh());
  file.append(0, std::vector<std::vector<double>>{{1, 2, 3, 4, 5}});
  file.append(9, std::vector<std::vector<double>>{{6, 7, 8, 9, 10}});
  const CommandResult header = run_command("ncdump -h '" + (folder / "profiles.nc").string() + "'");
  EXPECT_NE(header.text.find("double wind(time, z) ;"), std::string::npos) << header.text;
  EXPECT_EQ(stored(folder / "profiles.nc", "wind"),
            (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
}

TEST(RecordFile, resumed_file_equals_the_uninterrupted_one) {
  const ScratchFolder folder;
  SeriesFile whole = series_file(folder / "whole.nc");
  for (int n = 0; n < 900; ++n) whole.append(0.5 * n, std::vector<double>{sin(n), cos(n)});
  {
    SeriesFile part = series_file(folder / "part.nc");
    for (int n = 0; n < 600; ++n) part.append(0.5 * n, std::vector<double>{sin(n), cos(n)});
  }
  // A record at the resume time itself stays: outputs are written before the checkpoint.
  SeriesFile resumed = series_file(folder / "part.nc", Start::resume_at(0.5 * 123));
  ASSERT_EQ(resumed.times().size(), 124u);
  for (int n = 124; n < 900; ++n) resumed.append(0.5 * n, std::vector<double>{sin(n), cos(n)});
  for (const char* name : {"time", "energy", "volume"})
    EXPECT_EQ(stored(folder / "part.nc", name), stored(folder / "whole.nc", name)) << name;
}

TEST(RecordFile, resuming_before_the_first_record_starts_over) {
  const ScratchFolder folder;
  {
    SeriesFile file = series_file(folder / "series.nc");
    file.append(5, std::vector<double>{1, 2});
  }
  SeriesFile resumed = series_file(folder / "series.nc", Start::resume_at(4));
  resumed.append(4.5, std::vector<double>{3, 4});
  EXPECT_EQ(stored(folder / "series.nc", "energy"), std::vector<double>{3});
}

TEST(RecordFile, resuming_without_a_file_creates_it) {
  const ScratchFolder folder;
  SeriesFile resumed = series_file(folder / "series.nc", Start::resume_at(4));
  resumed.append(5, std::vector<double>{3, 4});
  EXPECT_EQ(stored(folder / "series.nc", "time"), std::vector<double>{5});
}

TEST(RecordFile, resuming_with_other_variables_is_refused_and_touches_nothing) {
  const ScratchFolder folder;
  {
    SeriesFile file = series_file(folder / "series.nc");
    for (int n = 0; n < 4; ++n) file.append(n, std::vector<double>{1, 2});
  }
  const std::string before = bytes_of(folder / "series.nc");
  EXPECT_THROW(SeriesFile(folder / "series.nc", {{"snow", "1", "snow"}}, sample_provenance(),
                          Start::resume_at(1)),
               Error);
  EXPECT_EQ(bytes_of(folder / "series.nc"), before);
}

TEST(Encoding, rounding_keeps_the_stated_bits_and_ties_go_to_even) {
  // With 2 explicit mantissa bits the neighbours of 1 are 1.25 apart by 0.25 up to 2.
  EXPECT_EQ(round_mantissa(1.125, 2), 1.0);  // tie, even below
  EXPECT_EQ(round_mantissa(1.375, 2), 1.5);  // tie, even above
  EXPECT_EQ(round_mantissa(1.126, 2), 1.25);
  EXPECT_EQ(round_mantissa(-1.126, 2), -1.25);
  EXPECT_EQ(round_mantissa(1.9, 2), 2.0);  // carries into the exponent
  EXPECT_EQ(round_mantissa(0.0, 2), 0.0);
  EXPECT_TRUE(std::isnan(round_mantissa(NAN, 2)));
  EXPECT_EQ(round_mantissa(INFINITY, 2), INFINITY);
  EXPECT_EQ(round_mantissa(M_PI, 0), M_PI);
}

TEST(Encoding, rounding_error_is_at_most_half_a_unit) {
  std::vector<float> floats;
  std::vector<double> doubles;
  std::vector<double> values;
  for (int n = 1; n < 4000; ++n) values.push_back(sin(n) * exp(0.01 * n));
  for (const int bits : {4, 12, 20}) {
    encode(values, {.mantissa_bits = bits}, floats, doubles);
    for (std::size_t i = 0; i < values.size(); ++i)
      // Half a unit in the last kept place relative to the value is 2^−(bits+1) at most; the
      // conversion of what is left to float32 is exact.
      EXPECT_LE(std::abs(floats[i] - values[i]), std::ldexp(std::abs(values[i]), -bits - 1));
  }
}

}  // namespace
}  // namespace pileus::output

// Collision efficiencies of drops that fall through still air, tabulated by Hall.
#pragma once
#include <array>
#include <cstddef>

namespace pileus::superdroplets {
namespace hall {

inline constexpr std::size_t ratios = 21;  // r/R = 0, 0.05 … 1
inline constexpr std::size_t given = 10;   // larger radii of the table
inline constexpr std::size_t radii = 30;   // R = 10, 20 … 300 µm
inline constexpr double spacing = 10e-6;   // of R, m
using Row = std::array<double, ratios>;

/// Hall (1980, doi:10.1175/1520-0469(1980)037<2486:ADMCOA>2.0.CO;2) as tabulated by Bott (1998,
/// doi:10.1175/1520-0469(1998)055<2284:AFMFTN>2.0.CO;2), for R in units of 10 µm. −1: not given,
/// the mean of its neighbours. Values above 1 are drops drawn into the wake of an equal one.
inline constexpr std::array<std::size_t, given> given_radius = {1, 2, 3, 4, 5, 6, 7, 10, 20, 30};
inline constexpr std::array<Row, given> given_rows = {{
    {0,  -1,   .0001, -1,   .014, -1,   .019, -1,   .027, -1,  .033,
     -1, .037, -1,    .038, -1,   .036, -1,   .032, -1,   .027},
    {0,    .0001, .0001, .005, .016, .022, .030, .043, .052, .064, .072,
     .079, .082,  .080,  .076, .067, .057, .048, .040, .033, .027},
    {0,  -1,   .002, -1,   .040, -1,   .170, -1,   .400, -1,  .550,
     -1, .590, -1,   .540, -1,   .490, -1,   .450, -1,   .520},
    {0,   .001, .070, .28,  .500, .62,  .680, .74,  .780, .80, .800,
     .80, .780, .77,  .760, .77,  .770, .78,  .790, .95,  1.40},
    {0,  .10,  .400, -1,   .700, -1,   .830, -1,   .880, -1,  .900,
     -1, .900, -1,   .880, -1,   .890, -1,   1.01, -1,   2.30},
    {0,   .05,  .430, .64,  .770, .84,  .870, .89,  .900, .91, .910,
     .91, .910, .91,  .920, .93,  .950, 1.0,  1.03, 1.7,  3.00},
    {0,  .20,  .580, -1,   .840, -1,   .900, -1,   .940, -1,  .950,
     -1, .950, -1,   .950, -1,   1.00, -1,   1.04, -1,   4.00},
    {0, .5, .790, .91, .950, .95, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {0, .87, .960, .98, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {0, .97, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
}};

constexpr Row complete(Row row) {
  for (std::size_t j = 1; j < ratios; j += 2)
    if (row[j] < 0) row[j] = 0.5 * (row[j - 1] + row[j + 1]);
  return row;
}

/// The table with the radii left out filled in linearly: the nodes keep their values, so that
/// interpolation between the rows of 10 µm is interpolation between the rows given.
constexpr std::array<Row, radii> tabulate() {
  std::array<Row, radii> table{};
  for (std::size_t g = 0; g + 1 < given; ++g) {
    const std::size_t from = given_radius[g], to = given_radius[g + 1];
    const Row low = complete(given_rows[g]), high = complete(given_rows[g + 1]);
    for (std::size_t i = from; i <= to; ++i) {
      const double share = static_cast<double>(i - from) / static_cast<double>(to - from);
      for (std::size_t j = 0; j < ratios; ++j)
        table[i - 1][j] = low[j] + share * (high[j] - low[j]);
    }
  }
  return table;
}
inline constexpr std::array<Row, radii> table = tabulate();

}  // namespace hall

/// Collision efficiency of drops of radii R ≥ r (m), bilinear in R and r/R; 0 for R < 10 µm, 1 from
/// 300 µm.
inline double hall_efficiency(double large, double small) {
  const double row = large * (1.0 / hall::spacing) - 1.0;
  constexpr double rounding = 1e-9;
  constexpr double last = static_cast<double>(hall::radii - 1);
  if (!(row >= -rounding)) return 0.0;
  if (row >= last - rounding) return 1.0;
  const double column = small / large * static_cast<double>(hall::ratios - 1);
  const auto i = static_cast<std::size_t>(static_cast<int>(row));
  auto j = static_cast<std::size_t>(static_cast<int>(column));
  j = j < hall::ratios - 2 ? j : hall::ratios - 2;
  const double u = row - static_cast<double>(static_cast<int>(i));
  const double v = column - static_cast<double>(static_cast<int>(j));
  const hall::Row &low = hall::table[i], &high = hall::table[i + 1];
  const double at_low = low[j] + v * (low[j + 1] - low[j]);
  const double at_high = high[j] + v * (high[j + 1] - high[j]);
  return at_low + u * (at_high - at_low);
}

}  // namespace pileus::superdroplets

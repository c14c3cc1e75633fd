// Rain that falls from parcel to parcel: each cell hands a share of every parcel's rain to the
// cells below it, which share it among their parcels. What leaves one arrives in another.
#pragma once
#include <cmath>
#include <cstdint>
#include <span>

namespace pileus::sedimentation {

/// One falling amount (mass or number) in the cells of one column, bottom first.
struct FallingAmount {
  std::span<double> held;  // in: Σ V q of the cell; out: what arrived in it
  std::span<double> kept;  // out: share that each parcel of the cell keeps of its own
  double ground = 0;       // out: Σ V q that reached the ground
};

/// Lets an amount fall for one step through a column of cells.
///
/// Per cell the Courant number C = v dt/Δz = n + f. Below one, the share f of every parcel's rain
/// goes to the next cell down; else all of it, 1 − f of it n cells down and f of it n + 1. Nothing
/// is redistributed within a cell, so that the mean fall is v dt exactly. Cells without parcels
/// (`volume` 0) pass on what they receive.
///
/// `courant` has the Courant numbers, `volume` the parcels' volumes; `arriving` is room for the
/// cells. Ensures   Σ held before = Σ kept·held before + Σ held after + ground, to rounding
inline void fall(FallingAmount& amount, std::span<const double> courant,
                 std::span<const double> volume, std::span<double> arriving) {
  const auto cells = static_cast<std::int64_t>(courant.size());
  for (double& a : arriving) a = 0;
  const auto hand = [&](std::int64_t cell, double what) {
    while (cell >= 0 && !(volume[static_cast<std::size_t>(cell)] > 0)) --cell;
    (cell >= 0 ? arriving[static_cast<std::size_t>(cell)] : amount.ground) += what;
  };
  for (std::int64_t k = cells - 1; k >= 0; --k) {
    const auto i = static_cast<std::size_t>(k);
    const double whole = std::floor(courant[i]);
    const double fraction = courant[i] - whole;
    amount.kept[i] = whole >= 1 ? 0.0 : 1.0 - fraction;
    if (!(amount.held[i] > 0)) continue;
    const std::int64_t far =
        whole < static_cast<double>(k) + 2 ? static_cast<std::int64_t>(whole) : k + 2;
    if (whole >= 1) hand(k - far, (1.0 - fraction) * amount.held[i]);
    if (fraction > 0) hand(k - far - 1, fraction * amount.held[i]);
  }
  for (std::size_t i = 0; i < arriving.size(); ++i) amount.held[i] = arriving[i];
}

}  // namespace pileus::sedimentation

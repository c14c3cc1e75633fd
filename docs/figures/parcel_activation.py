#!/usr/bin/python3
"""docs/images/parcel_activation.png: supersaturation and droplets over height of parcels that are
lifted at four speeds. From the root of the source tree:

    for w in '' _0_1 _0_5 _3; do
      ./pileus run configs/scenes/parcel_activation/parcel_activation$w.yaml
    done
    docs/figures/parcel_activation.py results docs/images/parcel_activation.png

The points are in docs/figures/parcel_activation.dat (configs/scenes/parcel_activation/reference.py
--curves).
"""
import pathlib
import subprocess
import sys

import netCDF4

SPEEDS = [(0.1, "_0_1", "#440154"), (0.5, "_0_5", "#31688e"), (1.0, "", "#1f9e89"),
          (3.0, "_3", "#d95f02")]
DENSITY = 9e4 / (287.05 * 283.15)  # kg m-3, of the air at the start

SCRIPT = """
set terminal pngcairo size 1000,480 font "sans,11"
set output "{picture}"
set multiplot layout 1,2 margins 0.085,0.98,0.13,0.96 spacing 0.1
set tics out nomirror
set border 3
set ylabel "height above the start / m"
set yrange [30:150]
set xlabel "supersaturation / %"
set xrange [-0.1:0.6]
set arrow 1 from 0,30 to 0,150 nohead lc rgb "#bbbbbb" back
set key at graph 1.0,0.98 right top spacing 1.3 samplen 2
plot {first}
unset arrow 1
unset key
set xlabel "droplets / cm^{{-3}}"
set xrange [0:1000]
plot {second}
"""


def read_run(folder, speed):
    with netCDF4.Dataset(folder / "series.nc") as file:
        heights = speed * file["time"][:]
        excess = 100 * (file["mean_relative_humidity"][:] - 1)
        number = 1e-6 * DENSITY * file["mean_number_of_cloud_droplets_per_mass_of_air"][:]
    return [f"{x:.6g} {n:.6g} {z:.6g}" for x, n, z in zip(excess, number, heights)]


def read_points(file, speed):
    rows = [line.split() for line in file.read_text().splitlines() if line[0] != "#"]
    return [f"{excess} {number} {z}" for w, z, excess, number in rows if float(w) == speed]


def main(results, picture):
    points = pathlib.Path(__file__).with_suffix(".dat")
    blocks, first, second = [], [], []
    for i, (speed, name, colour) in enumerate(SPEEDS):
        for kind, rows in (("l", read_run(pathlib.Path(results) / f"parcel_activation{name}", speed)),
                           ("p", read_points(points, speed))):
            blocks.append(f"${kind}{i} << EOD\n" + "\n".join(rows) + "\nEOD\n")
        line = f'with lines lw 2 lc rgb "{colour}"'
        dots = f'with points pt 6 ps 0.7 lc rgb "{colour}"'
        first += [f'$l{i} using 1:3 {line} title "{speed:g} m/s"',
                  f"$p{i} using 1:3 {dots} notitle"]
        second += [f"$l{i} using 2:3 {line}", f"$p{i} using 2:3 {dots}"]
    first.append('NaN with points pt 6 ps 0.7 lc rgb "#555555" title "reference"')
    script = SCRIPT.format(picture=picture, first=", ".join(first), second=", ".join(second))
    subprocess.run(["gnuplot"], check=True, text=True, input="".join(blocks) + script)


if __name__ == "__main__":
    main(*sys.argv[1:])

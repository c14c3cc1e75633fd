#!/usr/bin/python3
"""docs/images/kid_1d.png: liquid water over time and height of a lifted column. From the root of the
source tree:

    ./pileus run configs/scenes/kid_1d/kid_1d.yaml
    docs/figures/kid_1d.py results/kid_1d docs/images/kid_1d.png
"""
import subprocess
import sys

import netCDF4

SCRIPT = """
set terminal pngcairo size 900,460 font "sans,11"
set output "{picture}"
set xlabel "t / min"
set ylabel "z / km"
set cblabel "liquid water / (g/kg)"
set xrange [0:20]
set yrange [0:3]
set palette defined (0 "#f7fbff", 0.25 "#c6dbef", 0.5 "#6baed6", 0.75 "#2171b5", 1 "#08306b")
set tics out nomirror
set style line 1 lc rgb "#d95f02" lw 2 dt 2
unset key
set arrow 1 from 10,0 to 10,3 nohead ls 1 front
set label 1 "the updraught ends" at 10.2,0.25 tc rgb "#d95f02" front
plot "-" using 1:2:3 with image
{data}
e
"""


def main(folder, picture):
    with netCDF4.Dataset(f"{folder}/profiles.nc") as file:
        times, heights = file["time"][:], file["z"][:]
        liquid = file["mass_fraction_of_cloud_liquid_water_in_air"][:]
    rows = [f"{t / 60:.6g} {z / 1000:.6g} {q * 1000:.6g}"
            for t, column in zip(times, liquid) for z, q in zip(heights, column)]
    subprocess.run(["gnuplot"], check=True, text=True,
                   input=SCRIPT.format(picture=picture, data="\n".join(rows)))


if __name__ == "__main__":
    main(*sys.argv[1:])

#!/usr/bin/python3
"""docs/images/kid_1d_rain.png: cloud and rain of a lifted column over time and height, and what reaches
the ground by two schemes of collection. From the root of the source tree:

    ./pileus run configs/scenes/kid_1d/kid_1d_rain.yaml
    ./pileus run configs/scenes/kid_1d/kid_1d_rain_kogan.yaml
    docs/figures/kid_1d_rain.py results/kid_1d_rain results/kid_1d_rain_kogan docs/images/kid_1d_rain.png
"""
import subprocess
import sys

import netCDF4
import numpy

SCRIPT = """
set terminal pngcairo size 900,900 font "sans,11"
set output "{picture}"
set multiplot layout 3,1 margins 0.09,0.86,0.07,0.97 spacing 0.06
set xrange [0:60]
set tics out nomirror
unset key
set palette defined (0 "#f7fbff", 0.25 "#c6dbef", 0.5 "#6baed6", 0.75 "#2171b5", 1 "#08306b")
set ylabel "z / km"
set yrange [0:3]
set format x ""
set cblabel "cloud / (g/kg)"
plot "-" using 1:2:3 with image
{cloud}
e
set cblabel "rain / (g/kg)"
plot "-" using 1:2:3 with image
{rain}
e
set format x
set xlabel "t / min"
set ylabel "rain at the ground / (mm/h)"
set yrange [0:*]
set key top right
plot "-" using 1:2 with lines lw 2 lc rgb "#2171b5" title "Seifert and Beheng 2006", \\
     "-" using 1:2 with lines lw 2 lc rgb "#d95f02" title "Khairoutdinov and Kogan 2000"
{rates}
"""


def image(folder, name):
    with netCDF4.Dataset(f"{folder}/profiles.nc") as file:
        times, heights = file["time"][:], file["z"][:]
        values = file[name][:]
    return "\n".join(f"{t / 60:.6g} {z / 1000:.6g} {1000 * q:.6g}"
                     for t, column in zip(times, values) for z, q in zip(heights, column)
                     if 0 <= z <= 3000)


def rate(folder):
    """Rain in mm/h between the entries of the series a minute apart."""
    with netCDF4.Dataset(f"{folder}/series.nc") as file:
        times = numpy.asarray(file["time"][:])
        fallen = numpy.asarray(file["mean_rainfall_amount"][:])
    minutes = numpy.arange(0, times[-1] + 1, 60)
    amounts = numpy.interp(minutes, times, fallen)
    rows = [f"{(a + b) / 120:.6g} {(y - x) * 60:.6g}"
            for a, b, x, y in zip(minutes, minutes[1:], amounts, amounts[1:])]
    return "\n".join(rows) + "\ne"


def main(first, second, picture):
    script = SCRIPT.format(picture=picture,
                           cloud=image(first, "mass_fraction_of_cloud_liquid_water_in_air"),
                           rain=image(first, "mass_fraction_of_rain_in_air"),
                           rates=rate(first) + "\n" + rate(second))
    subprocess.run(["gnuplot"], check=True, text=True, input=script)


if __name__ == "__main__":
    main(*sys.argv[1:])

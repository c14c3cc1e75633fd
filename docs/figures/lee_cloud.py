#!/usr/bin/python3
"""docs/images/lee_cloud.png: the superdroplets of a raining cumulus by place and size. From the root of
the source tree:

    ./pileus run configs/scenes/lee_cloud/lee_cloud.yaml
    docs/figures/lee_cloud.py results/lee_cloud docs/images/lee_cloud.png
"""
import subprocess
import sys

import netCDF4
import numpy

TIMES = (900, 1200, 1500, 1800)  # s
SCRIPT = """
set terminal pngcairo size 1100,420 font "sans,10"
set output "{picture}"
set multiplot layout 1,{panels} margins 0.05,0.9,0.12,0.9 spacing 0.015
set xrange [0.5:2.06]
set yrange [0:2.5]
set cbrange [0:3]
set palette defined (0 "#c6dbef", 0.7 "#6baed6", 1.2 "#2171b5", 1.6 "#fdae61", 2.2 "#d73027", 3 "#67001f")
set cbtics ("1" 0, "10" 1, "100" 2, "1000" 3)
set cblabel "radius / µm"
set xlabel "x / km"
set tics out nomirror
unset key
unset colorbox
"""
PANEL = """
{last}
set title "{minutes:.0f} min"
{label}
plot "-" using 1:2:3 with points pt 7 ps 0.25 lc palette
{data}
e
"""


def droplets(path):
    """{time: (x, z, log10 of the radius in µm)} of all that hold more than haze does."""
    with netCDF4.Dataset(path) as dataset:
        group = dataset["droplets"]
        rows = numpy.concatenate(([0], numpy.cumsum(group["row_size"][:])))
        x, z, mass = (numpy.asarray(group[name][:]) for name in
                      ("x_position", "z_position", "droplet_water_mass"))
        times = numpy.asarray(group["time"][:])
    radius = numpy.cbrt(mass / 1000 * 3 / (4 * numpy.pi)) * 1e6
    found = {}
    for k, time in enumerate(times):
        part = slice(rows[k], rows[k + 1])
        wet = radius[part] > 1
        order = numpy.argsort(radius[part][wet])  # the large on top
        found[round(float(time))] = numpy.array(
            [x[part][wet][order], z[part][wet][order], numpy.log10(radius[part][wet][order])])
    return found


def main(folder, picture):
    records = droplets(f"{folder}/droplets.nc")
    script = SCRIPT.format(picture=picture, panels=len(TIMES))
    for number, time in enumerate(TIMES):
        x, z, size = records[time]
        data = "\n".join(f"{a / 1000:.4f} {b / 1000:.4f} {c:.3f}" for a, b, c in zip(x, z, size))
        script += PANEL.format(minutes=time / 60, data=data,
                               label='set ylabel "z / km"' if number == 0 else
                               'unset ylabel; set format y ""',
                               last='set colorbox user origin 0.915,0.12 size 0.015,0.78'
                               if number == len(TIMES) - 1 else "")
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


if __name__ == "__main__":
    main(*sys.argv[1:])

#!/usr/bin/python3
"""docs/images/bomex.png: liquid water path over time and mass fluxes over height of a BOMEX run,
beside what the intercomparison of Siebesma et al. (2003) gives. From the root of the source tree:

    ./pileus run configs/scenes/bomex/bomex_large.yaml
    docs/figures/bomex.py results/bomex_large docs/images/bomex.png
"""
import subprocess
import sys

import netCDF4
import numpy

# Siebesma et al. 2003, hours 3 to 6: mass flux of the cores, m/s, with 40 per cent to either side.
CORE = {650: 0.0275, 1000: 0.015, 1250: 0.009, 1500: 0.0055, 1950: 0.0}
CLOUD = {650: 0.0315, 1000: 0.017, 1250: 0.010, 1500: 0.006, 1950: 0.0}

SCRIPT = """
set terminal pngcairo size 1100,430 font "sans,11"
set output "{picture}"
set multiplot layout 1,3
set tics out nomirror
set style fill solid 0.35 noborder
set xlabel "t / h"
set ylabel "liquid water path / (g/m^2)"
set xrange [0:{hours}]
set yrange [0:*]
set key top right
plot 5 with filledcurves y1=9 lc rgb "#a6bddb" title "ensemble", \\
     "-" using 1:2 with lines lw 1.5 lc rgb "#d95f02" title "Pileus"
{path}
e
set xlabel "mass flux / (m/s)"
set ylabel "z / m"
set xrange [0:0.05]
set yrange [400:2200]
{fluxes}
unset multiplot
"""

FLUX = """
set title "{title}"
plot "-" using 2:1 with filledcurves closed lc rgb "#a6bddb" title "ensemble, 40 %", \\
     "-" using 2:1 with linespoints lw 1.5 pt 7 ps 0.5 lc rgb "#d95f02" title "Pileus, hour {hour}"
{band}
e
{data}
e
"""


def rows(*columns):
    return "\n".join(" ".join(f"{value:.6g}" for value in row) for row in zip(*columns))


def main(folder, picture):
    with netCDF4.Dataset(f"{folder}/series.nc") as file:
        time = numpy.asarray(file["time"][:]) / 3600
        path = 1e3 * numpy.asarray(file["atmosphere_mass_content_of_cloud_liquid_water"][:])
    fluxes = ""
    with netCDF4.Dataset(f"{folder}/profiles.nc") as file:
        z, hour = numpy.asarray(file["z"][:]), round(float(file["time"][-1]) / 3600)
        for title, name, ensemble in (("cores", "core_mass_flux", CORE),
                                      ("clouds", "cloud_mass_flux", CLOUD)):
            flux = numpy.asarray(file[name][-1])
            heights = list(ensemble)
            outline = ([0.6 * ensemble[h] for h in heights] +
                       [1.4 * ensemble[h] for h in reversed(heights)])
            fluxes += FLUX.format(title=title, hour=hour, data=rows(z, flux),
                                  band=rows(heights + heights[::-1], outline))
    subprocess.run(["gnuplot"], check=True, text=True,
                   input=SCRIPT.format(picture=picture, hours=round(time[-1]),
                                       path=rows(time, path), fluxes=fluxes))


if __name__ == "__main__":
    main(*sys.argv[1:])

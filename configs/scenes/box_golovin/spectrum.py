#!/usr/bin/python3
"""docs/images/golovin.png: the spectra of Golovin's box beside the exact ones, and what is left of the error
by the number of superdroplets. From the root of the source tree, within half an hour:

    for name in golovin golovin_large; do
      run="./pileus run configs/scenes/box_golovin/box_$name.yaml"
      $run --out results/$name --set output.checkpoint.steps=1200 --set output.checkpoint.kept=3
      $run --out results/${name}_start --set "time.end=0 s"
    done
    ./pileus study configs/studies/golovin.yaml
    configs/scenes/box_golovin/spectrum.py docs/images/golovin.png results/studies/golovin/study.csv \\
        results/golovin*

The droplets are those of the checkpoints, one picture for all folders; steps are taken as seconds.
"""
import csv
import glob
import re
import subprocess
import sys

import netCDF4
import numpy as np
from scipy.special import i1e

VOLUME, NUMBER, RADIUS, RATE, WATER = 1e6, 2.0 ** 23, 30.531e-6, 1500.0, 1000.0
TIMES = (0, 1200, 2400, 3600)
COLOURS = ("#7fcdbb", "#41b6c4", "#1d91c0", "#0c2c84")

SCRIPT = """
set terminal pngcairo size 1200,470 font "sans,11"
set output "{picture}"
set multiplot layout 1,2
set tics out nomirror
set border 3
set tmargin 2
set lmargin 9
{data}
set origin 0,0
set size 0.62,1
set logscale x
set xrange [8:4000]
set yrange [0:1.75]
set xlabel "radius / µm"
set ylabel "water per ln r / (g/m^3)"
set xtics (10, 20, 50, 100, 200, 500, 1000, 2000)
set key top right reverse Left samplen 2.2 width -2
set label 1 "start" at 45,1.55 tc rgb "{c[0]}"
set label 2 "20 min" at 108,0.87 center tc rgb "{c[1]}"
set label 3 "40 min" at 400,0.82 center tc rgb "{c[2]}"
set label 4 "60 min" at 1400,0.80 center tc rgb "{c[3]}"
plot {spectra}, \\
  NaN w l lw 7 lc rgb "#d0d0d0" t "exact", \\
  NaN w l lw 1.5 lc rgb "#404040" t "2^{{17}} superdroplets", \\
  NaN w p pt 6 ps 0.8 lc rgb "#404040" t "2^{{13}} superdroplets"
unset label
set origin 0.62,0
set size 0.38,1
set logscale xy
set xrange [1200:220000]
set yrange [1e-3:1]
set xtics ("2^{{11}}" 2048, "2^{{13}}" 8192, "2^{{15}}" 32768, "2^{{17}}" 131072)
set format y "10^{{%L}}"
set ytics add ("0.1 %%" 1e-3, "1 %%" 1e-2, "10 %%" 1e-1, "100 %%" 1)
set xlabel "superdroplets"
set ylabel "relative error, mean of twelve runs"
set key top right reverse Left samplen 1.5 width -4
plot {guides} \
  $errors using (0.96*$1):2:3:4 w yerrorbars pt 7 ps 1.1 lw 1.5 lc rgb "{c[3]}" notitle, \
  $errors using (1.04*$1):5:6:7 w yerrorbars pt 7 ps 1.1 lw 1.5 lc rgb "#d95f02" notitle, \
  NaN w p pt 7 ps 1.1 lc rgb "{c[3]}" t "drops after 60 min", \
  NaN w p pt 7 ps 1.1 lc rgb "#d95f02" t "second moment of mass, 20 min"
"""


def exact(radius, time):
    """Golovin's g(ln r), g m-3."""
    mean = 4 / 3 * np.pi * RADIUS ** 3
    x = (radius / RADIUS) ** 3
    tau = -np.expm1(-RATE * NUMBER * mean * time)
    if tau == 0:
        density = np.exp(-x)
    else:
        root = np.sqrt(tau)
        density = (1 - tau) * i1e(2 * x * root) * np.exp(-x * (1 - root) ** 2) / (x * root)
    return 3 * x ** 2 * density * NUMBER * mean * WATER * 1000


def estimate(radius, multiplicity, water):
    """The same of superdroplets: each spread by a Gaussian of ln r whose width is 0.62 n^(-1/5)."""
    width = 0.62 * len(water) ** -0.2
    place = np.log(np.cbrt(water / (4 / 3 * np.pi * WATER)))
    cell = width / 50  # gathered first
    first = np.floor(place.min() / cell)
    gathered = np.bincount((place / cell - first).astype(int), multiplicity * water)
    place = (first + 0.5 + np.arange(len(gathered))) * cell
    distance = (np.log(radius)[:, None] - place[None, :]) / width
    return np.exp(-0.5 * distance ** 2) @ gathered / (width * np.sqrt(2 * np.pi)) / VOLUME * 1000


def droplets(folders):
    """(multiplicity, mass) by number of superdroplets and time."""
    found = {}
    for folder in folders:
        for name in glob.glob(f"{folder}/checkpoint_*.h5"):
            time = int(re.search(r"_(\d+)\.h5$", name).group(1))
            with netCDF4.Dataset(name) as file:
                items = file["items"]
                some = (items["droplet_multiplicity"][:].astype(float), items["droplet_water_mass"][:])
            found[len(some[0]), time] = some
    return found


def block(name, rows):
    return f"${name} << EOD\n" + "\n".join(" ".join(f"{v:.6g}" for v in row) for row in rows) + "\nEOD"


def main(picture, study, *folders):
    found = droplets(folders)
    blocks, spectra = [], []
    fine, coarse = np.geomspace(8e-6, 4e-3, 400), np.geomspace(8e-6, 4e-3, 70)
    for time, colour in zip(TIMES, COLOURS):
        some = exact(fine, time)
        seen = some > 2e-3
        blocks.append(block(f"exact{time}", zip(fine[seen] * 1e6, some[seen])))
        spectra.append(f'$exact{time} w l lw 7 lc rgb "#70{colour[1:]}" notitle')
    for time, colour in zip(TIMES, COLOURS):
        for n, radius, style in ((131072, fine, "l lw 1.5"), (8192, coarse, "p pt 6 ps 0.8")):
            if (n, time) not in found:
                sys.exit(f"no {n} superdroplets at {time} s in {', '.join(folders)}")
            some = estimate(radius, *found[n, time])
            seen = some > 2e-3
            blocks.append(block(f"n{n}_{time}", zip(radius[seen] * 1e6, some[seen])))
            spectra.append(f'$n{n}_{time} w {style} lc rgb "{colour}" notitle')
    with open(study) as file:
        rows = [[float(row[c + e]) for c in ("error_number", "error_second_moment")
                 for e in ("", "_low", "_high")] + [float(row["superdroplets"])]
                for row in csv.DictReader(file)]
    blocks.append(block("errors", [row[-1:] + row[:-1] for row in rows]))
    guides = ", ".join(f'{rows[0][i] * rows[0][-1] ** 0.5}*x**-0.5 lw 1 dt 2 lc rgb "#808080" '
                       + ('t "n^{-1/2}"' if i else "notitle") for i in (0, 3)) + ","
    script = SCRIPT.format(picture=picture, data="\n".join(blocks), spectra=", \\\n  ".join(spectra),
                           guides=guides, c=COLOURS)
    subprocess.run(["gnuplot"], check=True, text=True, input=script)


if __name__ == "__main__":
    main(*sys.argv[1:])

#!/usr/bin/env python3
"""The moist thermal with different mixing: runs what has not been run, then writes the table of
docs/mixing.md and the data of its picture. From the root of the source tree:

    docs/figures/mixing.py PROGRAM RESULTS [--threads N]

PROGRAM is the pileus binary, RESULTS a folder for the runs (kept; a finished run is not repeated).
Writes docs/figures/mixing.dat and docs/figures/mixing_density.dat, prints the table, and draws
docs/images/mixing.{svg,png} with gnuplot. Needs python3-netcdf4.
"""
import argparse
import csv
import json
import math
import subprocess
from pathlib import Path

from netCDF4 import Dataset

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "configs/scenes/moist_thermal"
FIGURES = ROOT / "docs/figures"
Q_0 = 0.015  # unit of the liquid water, kg/kg
BINS, WIDTH = 49, 0.1 / 49
LIQUID = "mass_fraction_of_cloud_liquid_water_in_air"
Q_THERMAL = 1.231275e-3  # humidity of the undiluted thermal

# label, scene, settings
RUNS = [(f"beta_{beta}", "moist_thermal_nudged", [f"operators.mixing.beta={beta}"])
        for beta in ("0", "0.1", "0.3", "1", "3")] + [
            ("langevin", "moist_thermal_langevin", []),
            ("stretched", "moist_thermal_stretched", []),
            ("overlap", "moist_thermal_overlap", []),
        ]
PUBLISHED = ["EPIC", "MPIC", "MONC"]


def run(program, results, threads, label, scene, settings):
    folder = results / label
    if (folder / "summary.json").exists():
        return folder
    command = [program, "run", SCENES / f"{scene}.yaml", "--out", folder, "--force", "--quiet",
               "--threads", str(threads)]
    for setting in settings:
        command += ["--set", setting]
    subprocess.run([str(word) for word in command], check=True)
    return folder


def density(folder):
    """Volume-weighted density of q_l/q_0 of the last parcels written."""
    with Dataset(folder / "parcels.nc") as file:
        parcels = file["parcels"] if "parcels" in file.groups else file
        rows = parcels["row_size"][:]
        first = int(rows[:-1].sum())
        liquid = parcels[LIQUID][first:] / Q_0
        volume = parcels["volume"][first:]
    counts = [0.0] * BINS
    for value, weight in zip(liquid.tolist(), volume.tolist()):
        counts[min(max(int(value / WIDTH), 0), BINS - 1)] += weight
    total = sum(counts) * WIDTH
    return [c / total for c in counts]


def core_mode(values):
    """Centre of the fullest bin above q_l/q_0 = 0.02: the peak of the cloud's core, not of its
    edge. The published modes are those, too."""
    first = math.ceil(0.02 / WIDTH)
    best = max(range(first, BINS), key=lambda k: values[k])
    return (best + 0.5) * WIDTH


def measures(folder, values):
    summary = json.loads((folder / "summary.json").read_text())
    final = {name: entry["final"] for name, entry in summary["diagnostics"].items()}
    water = final["cloud_mean_total_water"]
    return {
        "cloud_fraction": final["cloud_fraction"],
        "mean_liquid": final["mean_liquid_water"] / Q_0,
        "cloud_mean": final["cloud_mean_liquid_water"] / Q_0,
        "cloud_deviation": final["cloud_liquid_water_deviation"] / Q_0,
        "water_deviation": final["cloud_total_water_deviation"] / Q_0,
        "mode": core_mode(values),
        "dilution": 1 - water / Q_THERMAL,
        "parcels": final["parcels"],
    }


def published():
    with open(SCENES / "published_scalars.csv", encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        for row in rows:
            if row["model"] in PUBLISHED and row["n"] in ("32", "256"):
                yield f"{row['model']}_{row['n']}", {
                    "cloud_fraction": float(row["cloud_volume_fraction"]),
                    "mean_liquid": float(row["mean_ql_over_q0"]),
                    "cloud_mean": float(row["incloud_mean"]),
                    "cloud_deviation": float(row["incloud_std"]),
                    "mode": float(row["mode_bin_centre"]),
                }


def write_table(rows):
    keys = ["cloud_fraction", "mean_liquid", "cloud_mean", "cloud_deviation", "mode",
            "water_deviation", "dilution", "parcels"]
    lines = ["# run " + " ".join(keys)]
    for label, values in rows:
        lines.append(label + "".join(f" {values[k]:.5g}" if k in values else " -" for k in keys))
    (FIGURES / "mixing.dat").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


def write_densities(densities):
    """A column for every run, that of a run that was not made full of question marks."""
    names = [label for label, _, _ in RUNS]
    lines = ["# density of q_l/q_0 by bin", "# bin " + " ".join(names)]
    for k in range(BINS):
        row = [f"{densities[n][k]:.5g}" if n in densities else "?" for n in names]
        lines.append(f"{(k + 0.5) * WIDTH:.6f} " + " ".join(row))
    (FIGURES / "mixing_density.dat").write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("results", type=Path)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--only", nargs="*", help="labels of runs to make and show")
    given = parser.parse_args()
    rows, densities = [], {}
    for label, scene, settings in RUNS:
        if given.only and label not in given.only:
            continue
        folder = run(given.program.resolve(), given.results, given.threads, label, scene, settings)
        values = density(folder)
        rows.append((label, measures(folder, values)))
        densities[label] = values
    write_table(rows + list(published()))
    write_densities(densities)
    schemes = int("overlap" in densities)
    subprocess.run(["gnuplot", "-e", f"schemes = {schemes}", FIGURES / "mixing.gp"], check=True,
                   cwd=ROOT)


if __name__ == "__main__":
    main()

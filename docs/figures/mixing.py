#!/usr/bin/env python3
"""The moist thermal with different mixing: runs what has not been run, then writes the tables of
docs/mixing.md and draws its picture. From the root of the source tree:

    docs/figures/mixing.py PROGRAM RESULTS [--threads N]

PROGRAM is the pileus binary, RESULTS a folder for the runs (kept; a finished run is not repeated).
Writes docs/figures/mixing.dat and docs/figures/mixing_density.dat, the tables between their marks
in docs/mixing.md, and docs/images/mixing.{svg,png} with gnuplot. Needs python3-netcdf4.
"""
import argparse
import csv
import json
import math
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENES = ROOT / "configs/scenes/moist_thermal"
FIGURES = ROOT / "docs/figures"
Q_0 = 0.015  # unit of the liquid water, kg/kg
BINS, WIDTH = 49, 0.1 / 49
LIQUID = "mass_fraction_of_cloud_liquid_water_in_air"
Q_THERMAL = 1.231275e-3  # humidity of the undiluted thermal

# label, name in the tables, scene, settings
NUDGED = [(f"beta_{beta}", f"β = {beta}", "moist_thermal_nudged", [f"operators.mixing.beta={beta}"])
          for beta in ("0", "0.1", "0.3", "1", "3")]
DILUTED = [("diluted", "growth and dilution", "moist_thermal_diluted", [])]
COARSE = ["domain.cells=[20, 20, 20]"]
OTHERS = [
    ("none_20", "none", "moist_thermal_nudged", ["operators.mixing.beta=0"] + COARSE),
    ("langevin_20", "Langevin displacement", "moist_thermal_langevin", COARSE),
    ("coherent_20", "coherent displacement", "moist_thermal_coherent", COARSE),
    ("stretched_20", "stochastic stretching", "moist_thermal_stretched", COARSE),
    ("diluted_20", "growth and dilution", "moist_thermal_diluted", COARSE),
    ("overlap_20", "overlap exchange", "moist_thermal_overlap", COARSE),
]
VORTICITY_TOO = [(f"vorticity_{beta}", f"β = {beta}, vorticity too", "moist_thermal_nudged",
                  [f"operators.mixing.beta={beta}", "operators.mixing.mix_vorticity=true",
                   f"operators.mixing.beta_vorticity={beta}"]) for beta in ("0.3", "1", "3")]
RUNS = NUDGED + DILUTED + OTHERS + VORTICITY_TOO
# The published runs take steps of 0.2 over the strain rate, too.
AUTHORS_STEP = ["time.step.alpha=0.2", "time.step.strain_alpha=0.2"]
PUBLISHED = ["EPIC", "MPIC", "MONC"]


def run(program, results, threads, label, scene, settings):
    folder = results / label
    if (folder / "summary.json").exists():
        return folder
    command = [program, "run", SCENES / f"{scene}.yaml", "--out", folder, "--force", "--quiet",
               "--threads", str(threads)]
    for setting in AUTHORS_STEP + settings:
        command += ["--set", setting]
    subprocess.run([str(word) for word in command], check=True)
    return folder


def density(folder):
    """Volume-weighted density of q_l/q_0 of the last parcels written."""
    from netCDF4 import Dataset  # here, so that what else is in this file needs no more than Python
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
    variance = "total_water_mass_fraction_variance"
    initial = summary["diagnostics"][variance]["initial"]
    return {
        "cloud_fraction": final["cloud_fraction"],
        "mean_liquid": final["mean_liquid_water"] / Q_0,
        "cloud_mean": final["cloud_mean_liquid_water"] / Q_0,
        "cloud_deviation": final["cloud_liquid_water_deviation"] / Q_0,
        "water_deviation": final["cloud_total_water_deviation"] / Q_0,
        "mode": core_mode(values),
        "dilution": 1 - final["cloud_mean_total_water"] / Q_THERMAL,
        "to_operators": final[f"{variance}_lost_to_operators"] / initial,
        "to_mergers": final[f"{variance}_lost_to_mergers"] / initial,
        "parcels": final["parcels"],
    }


def published():
    with open(SCENES / "published_scalars.csv", encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        found = {(row["model"], row["n"]): row for row in rows}
    for cells in ("32", "256"):
        for model in PUBLISHED:
            row = found[model, cells]
            yield f"{model}_{cells}", f"{model} {cells}³", {
                "cloud_fraction": float(row["cloud_volume_fraction"]),
                "mean_liquid": float(row["mean_ql_over_q0"]),
                "cloud_mean": float(row["incloud_mean"]),
                "cloud_deviation": float(row["incloud_std"]),
                "mode": float(row["mode_bin_centre"]),
            }


COLUMNS = {
    "cloud_fraction": ("cloud fraction", "{:.4f}"),
    "mean_liquid": ("mean q_l", "{:.3e}"),
    "cloud_mean": ("in cloud: mean q_l", "{:.4f}"),
    "cloud_deviation": ("deviation of q_l", "{:.4f}"),
    "water_deviation": ("deviation of q_t", "{:.4f}"),
    "mode": ("core mode", "{:.4f}"),
    "dilution": ("dilution", "{:.3f}"),
    "to_operators": ("variance of q_t lost to operators", "{:.2%}"),
    "to_mergers": ("to mergers", "{:.2%}"),
}


def write_data(rows):
    keys = [*COLUMNS, "parcels"]
    lines = ["# run " + " ".join(keys)]
    for label, _, values in rows:
        lines.append(label + "".join(f" {values[k]:.5g}" if k in values else " -" for k in keys))
    (FIGURES / "mixing.dat").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


def markdown(rows):
    lines = ["| run | " + " | ".join(title for title, _ in COLUMNS.values()) + " |",
             "| --- |" + " --- |" * len(COLUMNS)]
    for _, name, values in rows:
        cells = [form.format(values[key]).replace("%", " %") if key in values else ""
                 for key, (_, form) in COLUMNS.items()]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def put_into_page(mark, text):
    """Replaces what stands between <!-- mark --> and <!-- end of mark -->."""
    page = ROOT / "docs/mixing.md"
    begin, end = f"<!-- {mark} -->\n", f"\n<!-- end of {mark} -->"
    before, rest = page.read_text().split(begin)
    _, after = rest.split(end)
    page.write_text(before + begin + text + end + after)


def judge(rows):
    """What is expected of growing β: falling mode, rising cloud fraction, mean liquid kept."""
    series = [values for label, _, values in rows if label.startswith("beta_")]
    pairs = list(zip(series, series[1:]))
    print("core mode never rises with β:", all(b["mode"] <= a["mode"] for a, b in pairs))
    print("cloud fraction rises:",
          all(b["cloud_fraction"] > a["cloud_fraction"] for a, b in pairs))
    first = series[0]["mean_liquid"]
    print("mean liquid over that of the first:",
          " ".join(f"{values['mean_liquid'] / first:.3f}" for values in series))


def write_densities(densities):
    """A column for every run, that of a run that was not made full of question marks."""
    names = [label for label, *_ in RUNS]
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
    for label, name, scene, settings in RUNS:
        if given.only and label not in given.only:
            continue
        folder = run(given.program.resolve(), given.results, given.threads, label, scene, settings)
        values = density(folder)
        rows.append((label, name, measures(folder, values)))
        densities[label] = values
    write_data(rows + list(published()))
    write_densities(densities)
    judge(rows)
    coarse = {label for label, *_ in OTHERS}
    fine = [row for row in rows if row[0] not in coarse]
    put_into_page("table on 32³ cells", markdown(fine + list(published())))
    put_into_page("table on 20³ cells", markdown([row for row in rows if row[0] in coarse]))
    made = " ".join(str(2 + k) for k, (label, *_) in enumerate(RUNS) if label in densities)
    subprocess.run(["gnuplot", "-e", f"made = '{made}'", FIGURES / "mixing.gp"], check=True,
                   cwd=ROOT)


if __name__ == "__main__":
    main()

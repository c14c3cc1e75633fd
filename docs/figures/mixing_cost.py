#!/usr/bin/env python3
"""What each mixing scheme costs: processor time per parcel and step of the moist thermal on 20^3 cells
with the scheme, less that of the run without, in pairs one after the other on one thread. From the
root of the source tree:

    chrt -r 1 docs/figures/mixing_cost.py PROGRAM RESULTS [--pairs N]

PROGRAM is the pileus binary, RESULTS a folder for the runs. Real-time priority (chrt, as root) keeps
other processes off the core. Writes docs/figures/mixing_cost.dat and the table between its marks in
docs/mixing.md.
"""
import argparse
import json
import statistics
import subprocess
from pathlib import Path

from mixing import FIGURES, SCENES, put_into_page

# name in the table, scene, settings
SCHEMES = [
    ("grid nudging of two scalars", "moist_thermal_nudged", []),
    ("grid nudging of two scalars and vorticity", "moist_thermal_nudged",
     ["operators.mixing.mix_vorticity=true"]),
    ("Brownian displacement", "moist_thermal_langevin", ["operators.displacement.model=brownian"]),
    ("Langevin displacement", "moist_thermal_langevin", []),
    ("coherent displacement", "moist_thermal_coherent", []),
    ("stochastic stretching", "moist_thermal_stretched", []),
    ("growth and dilution", "moist_thermal_diluted", []),
    ("overlap exchange", "moist_thermal_overlap", []),
]
DATA = FIGURES / "mixing_cost.dat"
COMMON = ["domain.cells=[20, 20, 20]", "output.series.every=600 s",
          "diagnostics.variance_budgets=[]"]


def with_settings(command, settings):
    for setting in settings + COMMON:
        command += ["--set", setting]
    return [str(word) for word in command]


def run(program, folder, scene, settings):
    """ns of processor time per parcel and step of a run, and its number of parcel steps."""
    command = [program, "run", SCENES / f"{scene}.yaml", "--out", folder, "--force", "--quiet",
               "--threads", "1"]
    subprocess.run(with_settings(command, settings), check=True)
    summary = json.loads((folder / "summary.json").read_text())
    return summary["ns_per_parcel_step"], summary["steps"] * summary["parcels"]["mean"]


def stored(program, scene, settings):
    """Bytes that a run keeps per parcel."""
    command = with_settings([program, "plan", SCENES / f"{scene}.yaml", "--json"], settings)
    plan = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    return plan["data_flow"]["bytes_per_parcel"]


def measure(program, results, pairs):
    lines = ["# per parcel and step: ns of the scheme (median, least, most), of the run without; "
             "relative number of parcel steps"]
    for name, scene, settings in SCHEMES:
        extra, plain_time, steps = [], [], None
        for _ in range(pairs):
            plain = run(program, results / "cost_without", "moist_thermal", [])
            mixed = run(program, results / "cost_with", scene, settings)
            extra.append(mixed[0] - plain[0])
            plain_time.append(plain[0])
            steps = mixed[1] / plain[1]
        lines.append(f"{statistics.median(extra):.0f} {min(extra):.0f} {max(extra):.0f} "
                     f"{statistics.median(plain_time):.0f} {steps:.3f}  # {name}")
        print(lines[-1], flush=True)
    DATA.write_text("\n".join(lines) + "\n")


def table(program):
    rows = ["| scheme | µs per parcel and step | part of a step without | parcel steps | "
            "bytes kept per parcel |", "| --- | --- | --- | --- | --- |"]
    without = stored(program, "moist_thermal", [])
    for line, (name, scene, settings) in zip(DATA.read_text().splitlines()[1:], SCHEMES):
        middle, least, most, plain, steps = (float(word) for word in line.split("#")[0].split())
        kept = stored(program, scene, settings) - without
        rows.append(f"| {name} | {middle / 1e3:.2f} ({least / 1e3:.2f} … {most / 1e3:.2f}) | "
                    f"{100 * middle / plain:.0f} % | × {steps:.2f} | {kept:.0f} |")
    return "\n".join(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("results", type=Path)
    parser.add_argument("--pairs", type=int, default=3, help="0: the table of what was measured")
    given = parser.parse_args()
    program = given.program.resolve()
    if given.pairs > 0:
        measure(program, given.results, given.pairs)
    put_into_page("table of costs", table(program))


if __name__ == "__main__":
    main()

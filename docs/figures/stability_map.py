#!/usr/bin/env python3
"""The largest time-step factor alpha with which scenes stay accurate, and with which they survive.

    docs/figures/stability_map.py PROGRAM DATA [SCENE.yaml...]

PROGRAM is the pileus binary. Each scene is run with alpha, for strain and for buoyancy alike, from
10, the largest a scene may ask for, downwards, with the default schemes (Runge-Kutta of fourth
order, shapes by the matrix exponential) and with the cheapest (third order, shapes by the same
scheme). Neither the flow's speed nor the times of gridded output limit the step: alpha alone does. A
run is

  accurate  when every mark of the scene's own 'expect' section is kept;
  alive     when it ends, and the kinetic energy never exceeds twice the largest that the scene's
            accurate runs have.

The descent of a pair of schemes ends after two accurate runs in a row. One line per run is appended
to DATA; runs it holds already are not repeated. At the end the table is printed, and written beside
DATA as .csv, from which `gnuplot docs/figures/stability_map.gp` draws the picture.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = ("internal_wave_2d/internal_wave_2d_small", "taylor_green_2d/taylor_green_2d",
          "kelvin_helmholtz/kelvin_helmholtz_small", "robert_bubble/robert_bubble_small",
          "warm_bubble_2d/warm_bubble_2d_small", "straka/straka_small",
          "moist_thermal_2d/moist_thermal_2d_small", "internal_wave/internal_wave_small",
          "beltrami/beltrami_small", "taylor_green/taylor_green_small",
          "rayleigh_taylor/rayleigh_taylor_small", "moist_thermal/moist_thermal_small")
ALPHAS = (10, 6.4, 4.8, 3.2, 2.4, 1.6, 1.2, 0.8, 0.6, 0.4, 0.3, 0.2, 0.14, 0.1, 0.07, 0.05)
SCHEMES = (("rk4", "exponential"), ("rk3", "runge_kutta"))
# Only alpha limits the step: the speed does not, nor do records that a run stops at.
FREED = {"time.step.courant": 10, "output.fields.every": "0 s", "output.parcels.every": "0 s"}
COLUMNS = ("scene", "scheme", "shape", "alpha", "steps", "mean_step_s", "status",
           "max_kinetic_energy", "broken_shapes", "missed")
SURVIVED_GROWTH = 2


def settings(values):
    return [word for key, value in values.items() for word in ("--set", f"{key}={value}")]


def run(program, scene, scheme, shape, alpha):
    """One line of the data, as a dictionary of texts."""
    values = FREED | {"time.step.alpha": alpha, "time.step.strain_alpha": alpha,
                      "time.scheme": scheme, "numerics.shape_integrator": shape}
    row = {"scene": scene.stem, "scheme": scheme, "shape": shape, "alpha": f"{alpha:g}"}
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        ended = subprocess.run(
            [program, "run", str(scene), "--quiet", "--threads", "1", "--out", str(out),
             *settings(values)], capture_output=True, text=True, check=False)
        if not (out / "summary.json").exists():
            sys.exit(f"{scene} at alpha = {alpha:g}: {ended.stdout}{ended.stderr}")
        summary = json.loads((out / "summary.json").read_text())
    energy = summary["diagnostics"]["kinetic_energy"]["max"]
    missed = [f"{e['diagnostic']}" for e in summary["expect"] if not e["passed"]]
    steps = summary["steps"]
    broken = summary["diagnostics"]["broken_shapes"]["final"]
    return row | {
        "steps": str(steps), "status": summary["status"],
        "mean_step_s": f"{summary['simulated_time_s'] / steps if steps else 0:.4g}",
        "max_kinetic_energy": f"{energy:.5g}" if energy is not None else "nan",
        "broken_shapes": f"{broken:g}" if broken is not None else "nan",
        "missed": ",".join(dict.fromkeys(missed)) or "-"}


def read(path):
    if not path.exists():
        return []
    lines = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
    return [dict(zip(COLUMNS, line)) for line in lines]


def accurate(row):
    return row["status"] == "done" and row["missed"] == "-"


def alive(row, energy):
    return (row["status"] == "done"
            and float(row["max_kinetic_energy"]) <= SURVIVED_GROWTH * energy)


def descend(program, scene, scheme, shape, rows, data):
    kept = 0
    for alpha in ALPHAS:
        key = (scene.stem, scheme, shape, f"{alpha:g}")
        row = next((r for r in rows if tuple(r[c] for c in COLUMNS[:4]) == key), None)
        if row is None:
            row = run(program, scene, scheme, shape, alpha)
            rows.append(row)
            with data.open("a") as file:
                file.write(" ".join(row[column] for column in COLUMNS) + "\n")
        kept = kept + 1 if accurate(row) else 0
        if kept == 2:
            return


def largest(rows, holds):
    """The largest alpha below which every smaller one that was run holds too."""
    best = None
    for row in sorted(rows, key=lambda r: float(r["alpha"])):
        if not holds(row):
            break
        best = row
    return best


def summarise(rows):
    """[(scene, scheme, shape, row of the largest accurate alpha or None, of the largest alive or
    None, what the next larger alpha missed)], in the order of the data."""
    energy, groups = {}, {}
    for row in rows:
        groups.setdefault((row["scene"], row["scheme"], row["shape"]), []).append(row)
        if accurate(row):
            e = float(row["max_kinetic_energy"])
            energy[row["scene"]] = max(e, energy.get(row["scene"], 0.0))
    found = []
    for key, group in groups.items():
        exact = largest(group, accurate)
        living = largest(group, lambda r, e=energy.get(key[0], 0.0): alive(r, e))
        above = [r for r in group if exact is None or float(r["alpha"]) > float(exact["alpha"])]
        missed = min(above, key=lambda r: float(r["alpha"]))["missed"] if above else "-"
        found.append((*key, exact, living, missed))
    return found


def table(rows, csv):
    print(f"{'scene':26} {'RK':4} {'shape':12} {'accurate':>9} {'dt, s':>9} {'alive':>7} "
          f"{'dt, s':>9}  first missed")
    summary = summarise(rows)
    places = {scene: i for i, scene in enumerate(dict.fromkeys(entry[0] for entry in summary))}
    lines = ["scene,place,scheme,shape,accurate,alive"]
    for scene, scheme, shape, exact, living, missed in summary:
        show = [(r["alpha"], r["mean_step_s"]) if r else ("none", "-") for r in (exact, living)]
        print(f"{scene:26} {scheme:4} {shape:12} {show[0][0]:>9} {show[0][1]:>9} "
              f"{show[1][0]:>7} {show[1][1]:>9}  {missed}")
        numbers = [r["alpha"] if r else "" for r in (exact, living)]
        lines.append(",".join([scene.replace("_", " "), str(places[scene]), scheme, shape, *numbers]))
    csv.write_text("\n".join(lines) + "\n")


def main():
    program, data = sys.argv[1], Path(sys.argv[2])
    root = Path(__file__).resolve().parents[2] / "configs" / "scenes"
    scenes = [Path(a) for a in sys.argv[3:]] or [root / f"{name}.yaml" for name in SCENES]
    rows = read(data)
    if not rows:
        data.write_text("# " + " ".join(COLUMNS) + "\n")
    for scheme, shape in SCHEMES:
        for scene in scenes:
            descend(program, scene, scheme, shape, rows, data)
    table(rows, data.with_suffix(".csv"))


if __name__ == "__main__":
    main()

"""Two-moment clouds in a whole run: dry air is left alone, moist runs repeat and resume."""
import time

import netCDF4
import numpy

from program import CONFIGS, ProgramTest
from records import differences, variables

REAL_THERMAL = CONFIGS / "moist_thermal_real" / "moist_thermal_real_small.yaml"
BUSY = {"domain.cells": "[10, 10, 10]", "time.end": "420 s", "output.checkpoint.steps": 40,
        "output.fields.every": "60 s", "output.parcels.every": "120 s",
        "output.series.every": "10 s"}

DRY = """\
scene: {name: dry, title: Warm bubble in neutral air in the plane}
domain: {extent: [1 km, 1 km], cells: [20, 20]}
time: {end: 300 s}
initial:
  buoyancy: '0.016*exp(-((x - 500)^2 + (z - 260)^2)/100^2)'
output: {fields: {every: 60 s}, parcels: {every: 150 s}}
"""
LOADED = """\
extends: dry.yaml
initial: {air_potential_temperature: 300, specific_humidity: 0}
operators:
  - {use: org.pileus.two_moment, name: clouds, buoyancy: carried, collection: seifert_beheng}
  - {use: org.pileus.rain_sedimentation, name: fall}
"""


class TwoMoment(ProgramTest):

    def test_dry_run_with_the_scheme_loaded_equals_the_one_without(self):
        dry = self.run_well(self.write("dry.yaml", DRY), "dry")
        scene = self.write("loaded.yaml", LOADED)
        # Left to the planner, nothing of it would be there.
        planned = self.run_well(scene, "planned")
        self.assertEqual(planned.summary["operators"], {})
        loaded = self.run_well(scene, "loaded", {f"effects.{name}": "on" for name in (
            "condensation", "activation", "collection", "rain_evaporation", "sedimentation")})
        self.assertEqual(loaded.summary["steps"], dry.summary["steps"])
        compared = 0
        for file in ("fields.nc", "parcels.nc"):
            with netCDF4.Dataset(dry.out / file) as a, netCDF4.Dataset(loaded.out / file) as b:
                left, right = variables(a), variables(b)
                for name, variable in left.items():
                    if name == "scene":  # the text of the scene, which tells them apart
                        continue
                    x, y = numpy.asarray(variable[...]), numpy.asarray(right[name][...])
                    self.assertEqual(x.tobytes(), y.tobytes(), f"{file}: {name}")
                    compared += 1
        self.assertGreater(compared, 15)
        clouds = loaded.summary["operators"]["clouds"]
        self.assertEqual(clouds["repairs"], 0)
        # Every parcel was found inactive in every step.
        self.assertGreaterEqual(clouds["skipped"], dry.summary["steps"] * 1600)

    def test_moist_run_resumes_bit_by_bit(self):
        whole = self.run_well(REAL_THERMAL, "whole", BUSY)
        process = self.start_scene(REAL_THERMAL, "killed", BUSY)
        while process.poll() is None and not list((self.folder / "killed").glob("checkpoint_*.h5")):
            time.sleep(0.01)
        process.kill()
        process.wait()
        resumed = self.run_well(REAL_THERMAL, "killed", BUSY, ("--threads", "2", "--resume"))
        self.assertEqual(resumed.summary["state_sha256"], whole.summary["state_sha256"])
        self.assertEqual(differences(whole.out, resumed.out), [])
        self.assertGreater(whole.diagnostic("max_liquid_water")["max"], 1e-5)

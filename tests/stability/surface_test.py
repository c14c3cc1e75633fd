"""Quantities of the ground: in the files, in the fingerprint, and the same after a restart."""
import os

import numpy
from netCDF4 import Dataset

from program import THERMAL, USAGE, ProgramTest
from records import differences

OPERATOR = f"""
time: {{end: 120 s}}
operators:
  - use: {os.environ['PILEUS_SETTLING_TRACER']}
    name: settling
"""
DRY = """
initial:
  buoyancy: '0.016*exp(-((x - 500)^2 + (z - 260)^2)/100^2)'
"""
PLANE = DRY + """
  passive_tracer: 'z < 500 ? 1 : 0'
domain: {extent: [1 km, 1 km], cells: [20, 20]}
""" + OPERATOR + "    plane: true\n"
SOLID = DRY + """
  passive_tracer: '1 + sin(pi*x/500)'
domain: {extent: 1 km, cells: [8, 8, 8]}
""" + OPERATOR + "    depth: 300 m\n"
SHORT = {"time.end": "120 s", "output.fields.every": "30 s", "output.series.every": "10 s",
         "output.parcels.every": "0 s", "output.checkpoint.steps": 1}
FILES = ("fields.nc", "series.nc")


class Surface(ProgramTest):

    def scene(self, text):
        return self.write("scene.yaml", text)

    def assert_holds_what_was_lost(self, ended, cell_area, shape):
        """What lies on the ground, summed over its area, is what the parcels have lost."""
        with Dataset(ended.out / "fields.nc") as fields:
            fallen = fields["rainfall_amount"]
            self.assertEqual(fallen.dimensions[1:], ("y_cell", "x_cell")[-len(shape):])
            self.assertEqual(fallen.shape[1:], shape)
            self.assertEqual(fallen.units, "kg m-2")
            self.assertEqual(fallen.standard_name, "rainfall_amount")
            amounts = numpy.asarray(fallen[...], dtype=float)
        self.assertTrue((amounts[0] == 0).all())
        self.assertGreater(amounts[-1].max(), 0)
        lost = -ended.summary["budgets"]["tracer"]["sources"]
        self.assertGreater(lost, 0)
        # Written in single precision: 2^-24 for each column at most.
        self.assertAlmostEqual(amounts[-1].sum() * cell_area / lost, 1, delta=2 ** -24)
        final = {name: ended.diagnostic(f"{name}_rainfall_amount")["final"]
                 for name in ("mean", "max")}
        self.assertAlmostEqual(final["mean"] / amounts[-1].mean(), 1, delta=2 ** -23)
        self.assertAlmostEqual(final["max"] / amounts[-1].max(), 1, delta=2 ** -23)

    def test_fields_hold_what_was_lost_in_the_plane(self):
        ended = self.run_well(self.scene(PLANE), values=SHORT)
        self.assert_holds_what_was_lost(ended, 50.0, (20,))

    def test_fields_hold_what_was_lost(self):
        ended = self.run_well(self.scene(SOLID), values=SHORT)
        self.assert_holds_what_was_lost(ended, 125.0 * 125.0, (8, 8))

    def test_on_any_threads(self):
        scene = self.scene(SOLID)
        runs = [self.run_well(scene, f"on_{n}", SHORT, ("--threads", str(n))) for n in (1, 2, 3)]
        for run in runs[1:]:
            self.assertEqual(run.summary["state_sha256"], runs[0].summary["state_sha256"])
            self.assertEqual(differences(runs[0].out, run.out, FILES), [])

    def test_resumed_run_is_the_whole_one(self):
        scene = self.scene(PLANE)
        whole = self.run_well(scene, "whole", SHORT)
        self.run_well(scene, "parts", SHORT | {"time.max_steps": 4})
        parts = self.run_well(scene, "parts", SHORT, ("--threads", "2", "--resume"))
        self.assertEqual(parts.summary["state_sha256"], whole.summary["state_sha256"])
        self.assertEqual(parts.summary["diagnostics"], whole.summary["diagnostics"])
        found = differences(whole.out, parts.out, FILES)  # the scene's own text is another one
        self.assertEqual([line for line in found if ": scene:" not in line], [])

    def test_fingerprint_sees_the_ground(self):
        """Two states that differ in nothing but what lies on the ground: too little to be missed
        by the parcels, whose tracer is one."""
        hashes = set()
        for depth in ("-1 m", "100 m"):
            values = SHORT | {"time.end": "10 s"}
            text = PLANE + f"    depth: {depth}\n    time_scale: 1e20 s\n"
            hashes.add(self.run_well(self.scene(text), values=values,
                                     options=("--force",)).summary["state_sha256"])
        self.assertEqual(len(hashes), 2)

    def test_scenes_without_it_have_none(self):
        ended = self.run_well(THERMAL, values=SHORT | {"time.max_steps": 1})
        with Dataset(ended.out / "fields.nc") as fields:
            self.assertNotIn("x_cell", fields.variables)

    def test_can_be_the_only_field_and_is_found_when_misspelt(self):
        values = SHORT | {"output.fields.variables": "[rainfall_amount]"}
        ended = self.run_well(self.scene(PLANE), values=values)
        with Dataset(ended.out / "fields.nc") as fields:
            self.assertEqual(set(fields.variables), {"scene", "time", "x_cell", "rainfall_amount"})
        values["output.fields.variables"] = "[rainfal_amount]"
        self.assert_refused(self.run_scene(self.scene(PLANE), "other", values), USAGE,
                            "did you mean 'rainfall_amount'?")

    def test_a_checkpoint_without_it_cannot_be_continued(self):
        scene = self.scene(PLANE)
        without = self.write("without.yaml", PLANE.replace("operators:", "x-operators:"))
        self.run_well(without, values=SHORT | {"time.max_steps": 4})
        ended = self.run_scene(scene, values=SHORT, options=("--resume",))
        self.assert_refused(ended, USAGE, "does not hold the rainfall_amount of 20 columns")

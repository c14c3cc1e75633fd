"""What the program makes of input that is wrong: its exit code, its words, and what it leaves."""
import resource

import netCDF4
import numpy

from program import (ENDS_AT_WRITE, FILE, NUMERICAL, PLUGIN, RELAXING_THERMAL, THERMAL, USAGE,
                     WAVE, ProgramTest, contents)

SMALL = {"domain.cells": "[4, 4, 4]", "time.max_steps": 2}
CUBE = """domain: {extent: 1 km, cells: [4, 4, 4]}
time: {end: 10 s}
"""


class BadInput(ProgramTest):

    def refused_scene(self, text, code, *phrases):
        ended = self.run_scene(self.write("scene.yaml", text))
        self.assert_refused(ended, code, *phrases)
        self.assertFalse(ended.out.exists(), "a refused scene leaves nothing")

    def test_unknown_key(self):
        self.refused_scene(CUBE + "parcles: {per_cell: 8}\n", USAGE, "scene.yaml:3:1", "parcels")

    def test_wrong_unit(self):
        self.refused_scene(CUBE.replace("10 s", "10 kg"), USAGE, "scene.yaml:2:", "kg")

    def test_all_mistakes_at_once(self):
        self.refused_scene(CUBE.replace("end: 10 s", "end: 10 kg") + "sceen: {}\n", USAGE,
                           "scene.yaml:2:", "scene.yaml:3:")

    def test_missing_scene(self):
        self.assert_refused(self.run_scene(self.folder / "none.yaml"), USAGE, "none.yaml")

    def test_scene_is_a_folder(self):
        self.assert_refused(self.run_scene(self.folder), USAGE, str(self.folder))

    def test_unknown_setting(self):
        self.assert_refused(self.run_scene(WAVE, values={"time.ned": 1}), USAGE, "ned", "end")

    def test_unknown_plugin(self):
        self.refused_scene(CUBE + "operators: [{use: org.pileus.saturation_ajustment}]\n", PLUGIN,
                           "org.pileus.saturation_ajustment", "org.pileus.saturation_adjustment")

    def test_unknown_parameter_of_an_operator(self):
        self.refused_scene(
            CUBE + "operators: [{use: org.pileus.example_relaxation, time_scael: 1 h}]\n", USAGE,
            "time_scael", "time_scale")

    def test_results_folder_is_a_file(self):
        self.write("results", "mine")
        self.assert_refused(self.run_scene(WAVE, values=SMALL), FILE, "results")
        self.assertEqual((self.folder / "results").read_text(), "mine")

    def test_results_folder_cannot_be_made(self):
        self.assert_refused(self.run_scene(WAVE, "/proc/pileus", SMALL), FILE, "/proc/pileus")

    def test_existing_results_are_left_alone(self):
        first = self.run_well(WAVE, values=SMALL)
        (first.out / "notes.txt").write_text("mine")
        before = contents(first.out)
        for scene in (WAVE, THERMAL):
            self.assert_refused(self.run_scene(scene, values=SMALL), FILE, "--force", "--resume")
        self.assertEqual(contents(first.out), before)
        # Nor does a forced run remove them before it is known to be a good one.
        wrong = SMALL | {"output.fields.variables": "[buoyncy]"}
        self.assert_refused(self.run_scene(WAVE, values=wrong, options=("--force",)), USAGE,
                            "buoyncy", "buoyancy")
        self.assertEqual(contents(first.out), before)
        self.assertEqual(self.run_scene(WAVE, values=SMALL, options=("--force",)).code, 0)
        self.assertEqual((first.out / "notes.txt").read_text(), "mine")

    def test_full_disk(self):
        """At whatever change of a file the disk becomes full; what is there stays readable."""
        values = {"domain.cells": "[4, 4, 4]", "time.max_steps": 8, "output.checkpoint.steps": 2}
        for change in (0, 3, 20, 60, 100):
            ended = self.run_scene(THERMAL, f"full_{change}", values,
                                   env={"LD_PRELOAD": ENDS_AT_WRITE, "FULL_AFTER_WRITE": change})
            with self.subTest(change=change):
                self.assert_refused(ended, FILE, "No space left on device")
                for path in ended.out.glob("*.nc"):
                    netCDF4.Dataset(path).close()

    def test_file_size_limit(self):
        limit = 40000
        ended = self.run_scene(
            THERMAL, values=SMALL,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        self.assert_refused(ended, FILE, "File too large")

    def gridded(self, values):
        with netCDF4.Dataset(self.folder / "field.nc", "w") as file:
            for name in "zyx":
                file.createDimension(name, 5)
                file.createVariable(name, "f8", (name,))[:] = numpy.linspace(0, 1000, 5)
                file[name].units = "m"
            file.createVariable("field", "f8", ("z", "y", "x"))[...] = values
        return "{file: field.nc, variable: field}"

    def test_not_a_number_in_a_gridded_field(self):
        values = numpy.zeros((5, 5, 5))
        values[2, 2, 2] = numpy.nan
        field = self.gridded(values)
        relaxation = "operators: [{use: org.pileus.example_relaxation}]\n"
        for quantity, operators in (("buoyancy", ""), ("passive_tracer", relaxation)):
            scene = self.write("scene.yaml", f"{CUBE}initial: {{{quantity}: {field}}}\n{operators}")
            with self.subTest(quantity):
                ended = self.run_scene(scene, quantity)
                self.assertIn(ended.code, (USAGE, PLUGIN, NUMERICAL), ended.text)
                self.assertTrue(quantity in ended.text or "field.nc" in ended.text, ended.text)
                self.assertNotIn("this should not happen", ended.text)

    def test_values_that_break_the_solution(self):
        for name, vorticity in (("overflow", "1e200*sin(6.28e-3*x)"), ("collapse", "1e100*x*z")):
            initial = f"initial: {{vorticity: ['0', '{vorticity}', '0']}}\n"
            scene = self.write("scene.yaml", CUBE + initial)
            with self.subTest(name):
                ended = self.run_scene(scene, name)
                self.assert_refused(ended, NUMERICAL)
                bundles = list(ended.out.glob("failure-*.h5"))
                self.assertEqual(len(bundles), 1)
                self.assertIn(str(bundles[0]), ended.text)
                self.assertEqual(ended.summary["status"], "failed")

    def test_no_step_can_be_this_small(self):
        scene = self.write("scene.yaml",
                           CUBE.replace("end: 10 s", "end: 10 s, step: {fixed: 1e-30 s}"))
        self.assert_refused(self.run_scene(scene), NUMERICAL, "too small")

    def test_operator_values_out_of_range(self):
        ended = self.run_scene(RELAXING_THERMAL, values=SMALL | {"initial.passive_tracer": "1e9"})
        self.assert_refused(ended, NUMERICAL, "passive_tracer", "1000000000", "parcel", "failure-")

    def test_failure_of_an_operator_with_slashes_in_its_name(self):
        ended = self.run_scene(RELAXING_THERMAL, values=SMALL | {
            "initial.passive_tracer": "1e9", "operators.relaxation.name": "tracer/relaxed"})
        self.assert_refused(ended, NUMERICAL, "tracer/relaxed", "failure-tracer_relaxed-")

"""Statistics of slabs from outside: what is in the files, over restarts and threads, what is refused."""
import math
import subprocess

import netCDF4
import numpy
import xarray

from program import DONE, LIMIT, PROGRAM, THERMAL, USAGE, Ended, ProgramTest, environment
from records import differences, read

# A thermal that condenses after some 200 s, on a coarse mesh; records every third sample.
SCENE = f"""\
extends: {THERMAL}
domain: {{cells: [10, 10, 10]}}
time: {{end: 400 s}}
diagnostics:
  slabs:
    values:
      - {{name: late_flux, variable: buoyancy_flux, measure: value, height: 3 km, averaged_from: 250 s}}
      - {{name: cloud_level, variable: cloud_fraction, measure: height_of_max}}
      - {{name: stratification, variable: buoyancy, measure: slope, between: [1 km, 5 km]}}
output:
  fields: {{every: 0 s}}
  parcels: {{every: 0 s}}
  series: {{every: 15 s}}
  profiles: {{every: 60 s, sample: 20 s}}
expect:
  - {{diagnostic: late_flux, statistic: first_value, between: [-1, 1]}}
  - {{diagnostic: cloud_base_height, statistic: first_value, between: [500, 4000]}}
"""
FILES = ("profiles.nc", "series.nc")


class Slabs(ProgramTest):

    def setUp(self):
        super().setUp()
        self.scene = self.write("scene.yaml", SCENE)

    def test_files_tell_what_they_hold(self):
        ended = self.run_well(self.scene)
        with netCDF4.Dataset(ended.out / "profiles.nc") as file:
            self.assertEqual(file["time"].bounds, "time_bnds")
            bounds, times = file["time_bnds"][:], file["time"][:]
            numpy.testing.assert_array_equal(bounds[:, 1], times)
            numpy.testing.assert_array_equal(bounds[1:, 0], times[:-1])
            self.assertEqual(bounds[0, 0], 0)
            cloud = file["cloud_fraction"]
            self.assertEqual(cloud.standard_name, "cloud_area_fraction_in_atmosphere_layer")
            self.assertEqual(cloud.cell_methods, "time: mean area: mean")
            self.assertEqual(file["buoyancy_flux_of_parcels"].units, "m2 s-3")
            self.assertGreater(cloud[-1].max(), 0)
            self.assertEqual(cloud[0].max(), 0)
            # Two ways to one mean: nodes of the mesh, and parcels.
            mesh, parcels = file["buoyancy"][-1], file["buoyancy_of_parcels"][-1]
            self.assertLess(abs(mesh - parcels)[1:-1].max(), 0.01 * mesh.max())

    def test_xarray_reads_the_intervals(self):
        ended = self.run_well(self.scene)
        with xarray.open_dataset(ended.out / "profiles.nc") as data:
            self.assertEqual(data.time_bnds.dims, ("time", "nv"))
            self.assertTrue((data.time_bnds[:, 1] == data.time).all())

    def test_series_without_cloud_are_not_numbers(self):
        ended = self.run_well(self.scene)
        base = read(ended.out / "series.nc", "cloud_base_height")
        cover = read(ended.out / "series.nc", "cloud_area_fraction")
        self.assertTrue(math.isnan(base[0]))
        numpy.testing.assert_array_equal(numpy.isnan(base), cover == 0)
        self.assertEqual(ended.diagnostic("cloud_base_height")["min"], numpy.nanmin(base))
        late = read(ended.out / "series.nc", "late_flux")
        times = read(ended.out / "series.nc", "time")
        numpy.testing.assert_array_equal(numpy.isnan(late), times < 250)
        self.assertTrue(all(e["passed"] for e in ended.summary["expect"]), ended.summary["expect"])

    def test_a_record_is_the_mean_of_its_samples(self):
        averaged = self.run_well(self.scene, "averaged", {"time.max_steps": 40})
        single = self.run_well(self.scene, "single",
                               {"time.max_steps": 40, "output.profiles.every": "20 s"})
        for name in ("buoyancy", "buoyancy_flux", "buoyancy_flux_of_parcels", "core_mass_flux"):
            samples, times = (read(single.out / "profiles.nc", n) for n in (name, "time"))
            means, bounds = (read(averaged.out / "profiles.nc", n) for n in (name, "time_bnds"))
            for mean, (begin, end) in zip(means[1:], bounds[1:]):
                taken = samples[(times > begin) & (times <= end)]
                numpy.testing.assert_allclose(mean, taken.mean(axis=0), rtol=1e-12, atol=1e-18)

    def test_a_resumed_run_writes_the_same_averages(self):
        whole = self.run_well(self.scene, "whole")
        self.assertGreater(whole.summary["steps"], 18)
        for steps in (3, 7, 12, 18):
            out = f"parts_{steps}"
            self.run_well(self.scene, out, {"time.max_steps": steps})
            resumed = self.run_well(self.scene, out, options=("--threads", "1", "--resume"))
            self.assertEqual(resumed.summary["state_sha256"], whole.summary["state_sha256"])
            self.assertEqual(resumed.summary["diagnostics"], whole.summary["diagnostics"])
            # The files were begun by a run that was to end early; its last records are gone.
            self.assertEqual(differences(whole.out, resumed.out, FILES),
                             [f"{file}: scene: the value differs" for file in FILES])

    def test_threads_and_statistics_change_no_bits(self):
        one = self.run_well(self.scene, "one")
        three = self.run_well(self.scene, "three", options=("--threads", "3"))
        self.assertEqual(differences(one.out, three.out, FILES), [])
        plain = self.write("plain.yaml", SCENE[:SCENE.index("diagnostics:")] +
                           SCENE[SCENE.index("output:"):SCENE.index("expect:")] + "expect: []\n")
        without = self.run_well(plain, "without")
        self.assertEqual(one.summary["state_sha256"], without.summary["state_sha256"])

    def test_wrong_words_are_refused_with_the_right_ones(self):
        for wrong, phrases in (
                ("variable: core_mass_flx, height: 1 km", ("scene.yaml:", "core_mass_flux")),
                ("variable: core_mass_flux, measure: meen", ("scene.yaml:", "did you mean 'mean'")),
                ("variable: core_mass_flux", ("needs a 'height'",)),
                ("variable: buoyancy, measure: slope, between: [1000 m, 1001 m]", ("two levels",)),
                ("variable: buoyancy, measure: max, between: [2 km, 1 km]", ("lower height first",)),
                ("variable: buoyancy, height: 90 km", ("outside the domain",))):
            with self.subTest(wrong=wrong):
                scene = self.write("scene.yaml", f"extends: {THERMAL}\ndiagnostics:\n  slabs:\n"
                                   f"    values:\n      - {{name: mine, {wrong}}}\n")
                self.assert_refused(self.run_scene(scene), USAGE, *phrases)
                self.assert_refused(self.plan(scene), USAGE, *phrases)
                self.assertFalse((self.folder / "results").exists())

    def plan(self, scene):
        ended = subprocess.run([PROGRAM, "plan", str(scene)], env=environment(), text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LIMIT,
                               check=False)
        return Ended(ended.returncode, ended.stdout, None)

    def test_plan_knows_the_levels(self):
        """Cells of 100 m: between two levels there is nothing to measure."""
        for between, code in (("[110 m, 120 m]", USAGE), ("[110 m, 210 m]", DONE)):
            scene = self.write("scene.yaml", f"""\
domain: {{extent: 1 km, cells: [8, 8, 10]}}
time: {{end: 10 min}}
diagnostics:
  slabs:
    values:
      - {{name: mine, variable: buoyancy_flux, measure: max, between: {between}}}
""")
            ended = self.plan(scene)
            self.assertEqual(ended.code, code, ended.text)
            if code == USAGE:
                self.assert_refused(ended, USAGE, "scene.yaml:6:9", "at least one level")

    def test_names_that_no_diagnostic_can_have(self):
        for name, phrases in (("volume", ("scene.yaml:3:3", "'volume'", "another one")),
                              ("inversion_height", ("scene.yaml:3:3", "another one")),
                              ("time", ("scene.yaml:3:10", "its times")),
                              ("a b/c", ("scene.yaml:3:10", "letters, digits and underscores")),
                              ("''", ("scene.yaml:3:10", "letters, digits and underscores"))):
            with self.subTest(name=name):
                scene = self.write(
                    "scene.yaml", f"extends: {THERMAL}\ndiagnostics: {{slabs: {{values: [\n"
                    f"  {{name: {name}, variable: buoyancy, measure: max}}]}}}}\n")
                self.assert_refused(self.run_scene(scene), USAGE, *phrases)

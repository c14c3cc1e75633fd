"""Kessler's warm rain, a stranger's scheme of some size, is served as those of the tree are."""
import subprocess
import time

from project import HERE, LIMIT, PLUGINS, PROGRAM, WORK, ProjectTest, environment

PROJECT = HERE / "kessler"
RAINING, CLOUDY = PROJECT / "raining_thermal.yaml", PROJECT / "cloudy_thermal.yaml"
LIBRARIES = WORK / "build" / PLUGINS
# A coarse thermal until some of its rain has fallen.
COARSE = ("--set", "domain.cells=[16, 16]", "--set", "time.end=900", "--set",
          "output.series.every=100", "--threads", "1")
OFTEN = (*COARSE, "--set", "output.checkpoint.steps=20")


class Kessler(ProjectTest):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.build(cls(), PROJECT, WORK / "build", "-D",
                  "CMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror")

    def pileus(self, *words, **how):
        return self.call(PROGRAM, *words, PILEUS_PLUGIN_PATH=LIBRARIES, **how)

    def simulate(self, scene, out, *options):
        return super().simulate(scene, out, *options, plugins=LIBRARIES)

    def test_own_tests(self):
        self.run_tests_of(WORK / "build")

    def test_planned(self):
        """By the rules beside the library: on where water suffices, else watched, because a scheme
        with sources of heat and vapour leaves no bound rigorous."""
        text = self.pileus("plan", RAINING)
        for verdict in ("warm_rain +ON", "condensation +ON", "sedimentation +ON"):
            self.assertRegex(text, verdict)
        text = self.pileus("plan", CLOUDY)
        for verdict in ("warm_rain +WATCH", "sedimentation +WATCH"):
            self.assertRegex(text, verdict)
        why = self.pileus("plan", CLOUDY, "--why", "warm_rain")
        self.assertIn("cloud becomes rain beyond 0.02", " ".join(why.split()))

    def test_left_out_without_a_difference(self):
        """Cloud alone is the same as with rain that never forms."""
        without = self.simulate(CLOUDY, "without", *COARSE)
        forced = self.simulate(CLOUDY, "forced", *COARSE, "--set", "effects.warm_rain=on")
        self.assertEqual(without["effects"]["warm_rain"]["verdict"], "watch")
        cloud = "max_mass_fraction_of_cloud_liquid_water_in_air"
        self.assertGreater(without["diagnostics"][cloud]["max"], 1e-3)
        for same in (cloud, "mean_buoyancy", "kinetic_energy", "max_air_potential_temperature"):
            self.assertEqual(without["diagnostics"][same], forced["diagnostics"][same], same)
        self.assertEqual(forced["diagnostics"]["max_mass_fraction_of_rain_in_air"]["max"], 0)

    def test_skipped(self):
        """Clear air is not touched, which an audit of every skipped block confirms."""
        plain = self.simulate(RAINING, "plain", *COARSE)
        audited = self.simulate(RAINING, "audited", *COARSE, "--set", "coupling.audit=1")
        self.assertEqual(plain["state_sha256"], audited["state_sha256"])
        self.assertGreater(plain["operators"]["clouds"]["skipped"], 0)
        self.assertGreater(audited["operators"]["clouds"]["audited"], 0)

    def test_same_bits_on_any_number_of_threads(self):
        one = self.simulate(RAINING, "one", *COARSE)
        three = self.simulate(RAINING, "three", *COARSE[:-2], "--threads", "3")
        self.assertEqual(one["state_sha256"], three["state_sha256"])

    def test_killed_and_resumed(self):
        whole = self.simulate(RAINING, "whole", *OFTEN)
        self.assertGreater(whole["diagnostics"]["max_mass_fraction_of_rain_in_air"]["final"], 0)
        command = [PROGRAM, "run", RAINING, "--quiet", "--out", WORK / "killed", *OFTEN]
        process = subprocess.Popen([str(c) for c in command],
                                   env=environment(PILEUS_PLUGIN_PATH=LIBRARIES))
        begin = time.monotonic()
        while not list((WORK / "killed").glob("checkpoint_*.h5")):
            self.assertIsNone(process.poll(), "it was over before it could be killed")
            self.assertLess(time.monotonic() - begin, LIMIT)
            time.sleep(0.001)
        process.kill()
        process.wait()
        resumed = self.simulate(RAINING, "killed", *OFTEN, "--resume")
        for same in ("state_sha256", "steps", "diagnostics", "budgets"):
            self.assertEqual(resumed[same], whole[same], same)

    def test_reported(self):
        self.simulate(RAINING, "reported", *COARSE)
        rain = "mass_fraction_of_rain_in_air"
        self.pileus("report", WORK / "reported", "--field", rain, "--times", "900")
        self.assertIn(rain, (WORK / "reported" / "report.html").read_text())

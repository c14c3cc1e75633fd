"""The large scale in whole runs: balanced and inertial winds, closed budgets, threads, restarts."""
import math

from program import PLUGIN, USAGE, ProgramTest
from records import differences

# Half an inertial period of a sheared layer without stratification, f dt = 0.05.
ROTATING = """\
constants: {f: 1e-2 s-1, excess: 0 m/s}
domain: {extent: [4 km, 4 km, 1 km], cells: [4, 4, 8]}
time: {end: 0.5*pi/f s, step: {fixed: 5 s}}
background: {coriolis: f}
initial:
  vorticity: [1e-3, 2e-3 + 1e-3*excess, 0]
  mean_wind: [-9 + excess, 3.5]
operators:
  - use: org.pileus.large_scale_forcing
    name: large_scale
    geostrophic: true
    geostrophic_x_velocity: {height: [0 m, 1 km], value: [-10 m/s, -8 m/s]}
    geostrophic_y_velocity: {height: [0 m, 1 km], value: [4 m/s, 3 m/s]}
"""
WIND = {"mean_wind_x": -9, "mean_wind_y": 3.5, "mean_x_vorticity": 1e-3, "mean_y_vorticity": 2e-3}
# Trade-wind cumulus on a few columns, with everything that can act on it.
TRADES = """\
domain: {extent: [800 m, 800 m, 3 km], cells: [4, 4, 15]}
time: {end: 120 s, step: {largest: 10 s}}
background: {coriolis: 3.76e-5 s-1}
initial:
  liquid_water_potential_temperature:
    {height: [0 m, 520 m, 1480 m, 2 km, 3 km], value: [298.7 K, 298.7 K, 302.4 K, 308.2 K, 311.85 K]}
  total_water_mass_fraction:
    {height: [0 m, 520 m, 1480 m, 2 km, 3 km], value: [17e-3, 16.3e-3, 10.7e-3, 4.2e-3, 3e-3]}
  vorticity: [0, 'z > 700 ? 1.8e-3 : 0', '0']
  mean_wind: [-8 m/s, 0 m/s]
operators:
  - {use: org.pileus.saturation_adjustment, name: condensation, thermodynamics: real}
  - use: org.pileus.large_scale_forcing
    name: large_scale
    subsidence_velocity: {height: [0 m, 1500 m, 2100 m], value: [0 m/s, -0.0065 m/s, 0 m/s]}
    subsidence_of: scalars_and_wind
    potential_temperature_tendency: {height: [1500 m, 2500 m], value: [-2/86400 K/s, 0 K/s]}
    total_water_tendency: {height: [300 m, 500 m], value: [-1.2e-8 s-1, 0 s-1]}
    geostrophic: true
    geostrophic_x_velocity: {height: [0 m, 3 km], value: [-10 m/s, -4.6 m/s]}
    sponge_rate: {height: [2500 m, 3 km], value: [0 s-1, 2e-3 s-1]}
    sponge_of: vorticity_and_scalars
output: {series: {every: 10 s}, checkpoint: {steps: 5}}
"""
# The same air with clouds of droplets in part of it.
CLOUDY = (TRADES.replace("liquid_water_potential", "air_potential")
          .replace("total_water_mass_fraction", "specific_humidity")
          .replace("saturation_adjustment", "two_moment").replace(", thermodynamics: real", "")
          .replace("  vorticity:", """\
  mass_fraction_of_cloud_liquid_water_in_air: 'z > 800 && z < 1400 && x < 400 ? 1e-3*(z/800 - 1) : 0'
  number_of_cloud_droplets_per_mass_of_air: 'z > 800 && z < 1400 && x < 400 ? 1e8*(z/800 - 1) : 0'
  vorticity:"""))
NUDGED = """\
domain: {extent: [1 km, 1 km], cells: [4, 8]}
time: {end: 600 s, step: {fixed: 20 s}}
initial: {mean_wind: 3}
operators:
  - use: org.pileus.large_scale_forcing
    name: large_scale
    wind_nudging_time: 10 min
    target_x_velocity: {height: [0 m, 1 km], value: [-8 m/s, -6 m/s]}
"""


class LargeScaleForcing(ProgramTest):

    def final(self, ended, name):
        return ended.diagnostic(name)["final"]

    def test_geostrophic_wind_stays(self):
        """The pressure gradient completes the core's rotation of the wind; what is left of the shear
        is the error of the step's scheme."""
        ended = self.run_well(self.write("scene.yaml", ROTATING))
        for name, value in WIND.items():
            self.assertAlmostEqual(self.final(ended, name) / value, 1, delta=1e-3, msg=name)

    def test_ageostrophic_wind_turns_inertially(self):
        """du'/dt = f v', dv'/dt = -f u' at every height: after a quarter of the period an excess of
        1 m/s along the wind, with a shear of 1e-3 per second, lies across it, to the right."""
        ended = self.run_well(self.write("scene.yaml", ROTATING), values={"constants.excess": "1 m/s"})
        angle = 1e-2 * ended.summary["simulated_time_s"]
        for name, scale, part in (
                ("mean_wind_x", 1, math.cos(angle)), ("mean_wind_y", 1, -math.sin(angle)),
                ("mean_y_vorticity", 1e-3, math.cos(angle)), ("mean_x_vorticity", 1e-3, math.sin(angle))):
            turned = (self.final(ended, name) - WIND[name]) / scale
            self.assertAlmostEqual(turned, part, delta=5e-3, msg=name)

    def test_nudged_wind_approaches_the_target(self):
        ended = self.run_well(self.write("scene.yaml", NUDGED))
        left = math.exp(-1)
        self.assertAlmostEqual(self.final(ended, "mean_wind_x"), -7 + 10 * left, delta=1e-9)
        # In the plane the vorticity is minus the shear.
        self.assertAlmostEqual(self.final(ended, "mean_vorticity"), -2e-3 * (1 - left), delta=1e-7)

    def test_books_close(self):
        """What heat and water have changed by is what was booked: mergers and means of the levels
        round, no more."""
        ended = self.run_well(self.write("scene.yaml", TRADES))
        for budget in ("heat", "water"):
            self.assertNotEqual(ended.summary["budgets"][budget]["sources"], 0)
            self.assertLess(abs(self.final(ended, f"{budget}_budget_defect")), 1e-13)

    def test_books_of_clouds_close(self):
        """Cloud water sinks in proportion to what parcels have: none becomes negative."""
        ended = self.run_well(self.write("scene.yaml", CLOUDY))
        for budget in ("water", "droplets_and_aerosol"):
            self.assertNotEqual(ended.summary["budgets"][budget]["sources"], 0)
            self.assertLess(abs(self.final(ended, f"{budget}_budget_defect")), 1e-13)
        for what in ("mass_fraction_of_cloud_liquid_water_in_air", "specific_humidity"):
            self.assertGreaterEqual(ended.diagnostic(f"min_{what}")["min"], 0)

    def test_on_any_threads(self):
        scene = self.write("scene.yaml", TRADES)
        runs = [self.run_well(scene, f"on_{n}", options=("--threads", str(n))) for n in (1, 2, 3)]
        for run in runs[1:]:
            self.assertEqual(run.summary["state_sha256"], runs[0].summary["state_sha256"])
            self.assertEqual(differences(runs[0].out, run.out), [])

    def test_resumed_run_is_the_whole_one(self):
        scene = self.write("scene.yaml", TRADES)
        whole = self.run_well(scene, "whole")
        self.run_well(scene, "parts", {"time.max_steps": 4})
        resumed = self.run_well(scene, "parts", options=("--threads", "2", "--resume"))
        self.assertEqual(resumed.summary["state_sha256"], whole.summary["state_sha256"])
        self.assertEqual(resumed.summary["budgets"], whole.summary["budgets"])
        # The files of the first session keep its scene, which ended sooner.
        self.assertEqual([line for line in differences(whole.out, resumed.out)
                          if not line.endswith("scene: the value differs")], [])

    def test_wrong_input_is_named(self):
        for name, scene, code, phrases in (
                ("negative", NUDGED.replace("10 min", "-10 min"), USAGE,
                 ("wind_nudging_time", "scene.yaml:7:")),
                ("unnudged", NUDGED.replace("    wind_nudging_time: 10 min\n", ""), USAGE,
                 ("target_x_velocity", "scene.yaml:7:", "wind_nudging_time != 0")),
                ("across", NUDGED + "    y_wind_tendency: 1e-3 m/s2\n", PLUGIN,
                 ("y_wind_tendency", "plane")),
                ("dry", NUDGED + "    total_water_tendency: 1e-8 s-1\n", PLUGIN,
                 ("total_water_tendency", "specific_humidity")),
                ("still", NUDGED + "    geostrophic: true\n", PLUGIN, ("background.coriolis",))):
            with self.subTest(name):
                self.assert_refused(self.run_scene(self.write("scene.yaml", scene), name), code,
                                    *phrases)

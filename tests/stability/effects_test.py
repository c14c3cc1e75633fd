"""What is left out changes no bit: automatic plans against everything forced on."""
import json
import subprocess

import netCDF4
import numpy

from program import CONFIGS, NUMERICAL, PROGRAM, USAGE, ProgramTest, environment
from records import variables

BUBBLE = CONFIGS / "unsaturated_bubble" / "unsaturated_bubble_small.yaml"
# The bubble made so moist that its top saturates on the way, after some three minutes.
MOIST = {"constants.q_bubble": 0.0195, "time.end": "300 s", "output.fields.every": "300 s",
         "output.profiles.every": "300 s", "output.parcels.every": "300 s",
         "output.series.every": "50 s"}
STEPS = 4  # compared where a scene's verdicts are all on, and in variants of a scene
LARGEST = 12000  # parcels; larger scenes are compared on a coarser mesh
COARSE = {2: "[32, 24]", 3: "[12, 12, 10]"}

# Humid air that rises in a box too low for it to saturate, with clouds and rain carried apart.
DROPS = """\
scene: {name: drops, title: Humid bubble in the plane that forms no drop}
domain: {extent: [1 km, 1 km], cells: [20, 20]}
time: {end: 200 s}
formulas: {shape: 'exp(-((x - 500)^2 + (z - 260)^2)/150^2)'}
initial:
  air_potential_temperature: 300 + 0.5*shape
  specific_humidity: 0.006 + 0.002*shape
operators:
  - {use: org.pileus.two_moment, name: clouds, collection: seifert_beheng,
     saturation_pressure: murphy_koop}
  - {use: org.pileus.rain_sedimentation, name: fall}
output: {fields: {every: 50 s}, parcels: {every: 100 s}}
"""
# Cold and warm air, both too dry for a cloud, that mix to fog without moving.
FOG = """\
scene: {name: fog, title: Cold and warm air that mix to fog}
domain: {extent: [800 m, 400 m], cells: [8, 8]}
time: {end: 40 s, step: {fixed: 2 s}}
formulas:
  T: 'x < 400 ? 275 : 300'
  vapour: 611.2*exp(17.67*(T - 273.15)/(T - 29.65))
initial:
  air_potential_temperature: T
  specific_humidity: 0.66*0.622*vapour/(100000 - 0.378*vapour)
operators:
  - {use: org.pileus.grid_nudging, name: mixing, beta: 10}
  - {use: org.pileus.two_moment, name: clouds, activation: twomey, twomey_coefficient: 100 cm-3,
     twomey_exponent: 0, buoyancy_temperature: 290 K, reference_height: [0 m],
     reference_potential_temperature: [290 K]}
output: {series: {every: 100 s}}
"""
# The same air so moist that it saturates on the way.
MOIST_DROPS = {"initial.specific_humidity": "0.0130 + 0.0045*shape", "time.end": "300 s"}
RAIN = ("mass_fraction_of_rain_in_air", "number_of_raindrops_per_mass_of_air")
DROPLETS = ("mass_fraction_of_cloud_liquid_water_in_air",
            "number_of_cloud_droplets_per_mass_of_air")


def is_quick_variant(scene):
    """Whether it is the one of its folder that `pileus check` takes; it is run to its end."""
    small = scene.parent / f"{scene.parent.name}_small.yaml"
    return scene == (small if small.is_file() else scene.parent / f"{scene.parent.name}.yaml")


def size_of(plan):
    """Overrides that make a scene small enough for a test."""
    if plan["data_flow"]["parcels"] <= LARGEST:
        return {}
    names = [one["name"] for one in plan["data_flow"]["stored"]]
    return {"domain.cells": COARSE[3 if "y_position" in names else 2]}


def plan_of(scene, *options):
    ended = subprocess.run([PROGRAM, "plan", str(scene), "--json", *options], env=environment(),
                           capture_output=True, text=True, check=True)
    return json.loads(ended.stdout)


class EffectsProgramTest(ProgramTest):
    def forced_on(self, scene, plan):
        """A scene that switches every effect on that an operator of it provides."""
        effects = "".join(f"  {name}: on\n" for name, effect in plan["effects"].items()
                          if effect["provided_by"])
        return self.write("forced_" + scene.name, f"extends: {scene}\neffects:\n{effects}")

    def test_automatic_plans_give_the_bits_of_everything_on(self):
        scenes = [scene for scene in CONFIGS.rglob("*.yaml") if scene.parent.name < "moist"]
        self.assertGreater(self.compare_plans(scenes), 5)

    def test_automatic_plans_give_the_bits_of_everything_on_in_moist_scenes(self):
        scenes = [scene for scene in CONFIGS.rglob("*.yaml") if scene.parent.name >= "moist"]
        self.assertGreater(self.compare_plans(scenes), 10)

    def test_automatic_plans_give_the_bits_of_everything_on_in_hard_cases(self):
        self.assertGreater(self.compare_plans((CONFIGS.parent / "hard").glob("*.yaml")), 3)

    def compare_plans(self, scenes):
        """Runs all scenes that have operators as planned and with all effects on."""
        compared = 0
        for scene in sorted(scenes):
            plan = plan_of(scene)
            if not plan["operators"]:
                continue  # nothing that could be left out
            with self.subTest(scene=scene.stem):
                left_out = [name for name, effect in plan["effects"].items()
                            if effect["provided_by"] and effect["verdict"] != "on"]
                whole = left_out and is_quick_variant(scene)
                values = {} if whole else size_of(plan) | {"time.max_steps": STEPS}
                planned = self.run_well(scene, out="auto_" + scene.stem, values=values)
                forced = self.run_well(self.forced_on(scene, plan), out="on_" + scene.stem,
                                       values=values)
                self.assertEqual(planned.summary["state_sha256"], forced.summary["state_sha256"])
                compared += 1
        return compared

    def test_clouds_that_cannot_form_have_no_arrays_and_the_air_has_the_same_bits(self):
        scene = self.write("drops.yaml", DROPS)
        plan = plan_of(scene)
        off = self.run_well(scene, "off")
        on = self.run_well(self.forced_on(scene, plan), "on")
        for name in ("condensation", "activation", "collection", "rain_evaporation",
                     "sedimentation"):
            self.assertEqual(off.summary["effects"][name]["verdict"], "off", name)
        self.assertNotIn("fall", off.summary["operators"])
        clouds = off.summary["operators"]["clouds"]
        self.assertEqual(clouds["skipped"], 0)  # nobody asked whether parcels are active
        self.assertGreater(on.summary["operators"]["clouds"]["skipped"], 0)
        # Mass and number of drops and of rain, the previous height, relative humidity: 8 B each.
        self.assertEqual(off.summary["left_out"]["bytes_per_parcel"], 6 * 8)
        compared = 0
        for file in ("fields.nc", "parcels.nc"):
            with netCDF4.Dataset(off.out / file) as a, netCDF4.Dataset(on.out / file) as b:
                left, right = variables(a), variables(b)
                for name, variable in left.items():
                    if name in ("scene", "plan"):  # texts, which tell them apart
                        continue
                    x, y = (numpy.asarray(v[...]) for v in (variable, right[name]))
                    self.assertEqual(x.tobytes(), y.tobytes(), f"{file}: {name}")
                    compared += 1
                for name in set(right) - set(left):
                    if name.split("/")[-1] in DROPLETS + RAIN:
                        self.assertFalse(numpy.any(right[name][...]), name)
        self.assertGreater(compared, 15)

    def test_watched_clouds_switch_on_and_equal_the_run_that_had_them(self):
        scene = self.write("drops.yaml", DROPS)
        on = self.run_well(scene, "on", MOIST_DROPS | {"effects.condensation": "on"})
        watched = self.run_well(scene, "watched", MOIST_DROPS | {"effects.condensation": "watch"})
        reason = watched.summary["effects"]["condensation"]["reason"]
        self.assertRegex(reason, r"switched on at t = [0-9.]+ s, step [1-9][0-9]")
        self.assertEqual(watched.summary["state_sha256"], on.summary["state_sha256"])
        self.assertGreater(on.diagnostic("max_liquid_water")["final"], 1e-5)

    def test_what_one_operator_calls_for_another_does_in_the_same_step(self):
        scene = self.write("fog.yaml", FOG)
        for order in ("[clouds, mixing]", "[mixing, clouds]"):
            for scheme in ("lie", "strang"):
                with self.subTest(order=order, scheme=scheme):
                    values = {"coupling.order": order, "coupling.scheme": scheme}
                    runs = [self.run_well(scene, f"{word} {order} {scheme}",
                                          values | {"effects.condensation": word})
                            for word in ("on", "watch")]
                    self.assertEqual(*(run.summary["state_sha256"] for run in runs))
                    self.assertIn("switched on", runs[1].summary["effects"]["condensation"]["reason"])
                    self.assertGreater(runs[0].diagnostic("max_liquid_water")["final"], 1e-6)

    def test_costs_are_measured_where_the_scene_lists_its_effects(self):
        """A cache that others have damaged costs no run its summary."""
        scene = self.write("dry.yaml", DROPS + "effects: [buoyancy]\n")
        cache = self.folder / "cache"
        for _ in range(2):
            ended = subprocess.run(
                [PROGRAM, "plan", str(scene), "--measure"], capture_output=True, text=True,
                env=environment(XDG_CACHE_HOME=cache), check=False)
            self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
            self.assertIn("left out", ended.stdout)
            self.assertNotIn("its time has not been measured", ended.stdout)
            [costs] = (cache / "pileus").glob("costs-*.json")
            costs.write_text('{"core 2 rk4": {"core_seconds_per_parcel_step": null, "when": 3}}')
        self.run_well(scene, values={"time.max_steps": 2}, env={"XDG_CACHE_HOME": cache})

    def test_rain_left_out_on_demand_has_no_arrays(self):
        scene = self.write("drops.yaml", DROPS)
        run = self.run_well(scene, values=MOIST_DROPS | {"effects.collection": "off"})
        self.assertEqual(run.summary["effects"]["condensation"]["verdict"], "on")
        stored = {one["name"] for one in
                  json.loads((run.out / "plan.json").read_text())["data_flow"]["stored"]}
        self.assertTrue(stored.issuperset(DROPLETS))
        self.assertTrue(stored.isdisjoint(RAIN))
        self.assertNotIn("fall", run.summary["operators"])

    def test_condensation_left_out_has_no_array_and_the_same_bits(self):
        values = {"time.end": "200 s"}
        off = self.run_well(BUBBLE, values=values)
        on = self.run_well(BUBBLE, out="on", values=values | {"effects.condensation": "on"})
        self.assertEqual(off.summary["effects"]["condensation"]["verdict"], "off")
        self.assertEqual(on.summary["effects"]["condensation"]["verdict"], "on")
        self.assertEqual(off.summary["state_sha256"], on.summary["state_sha256"])
        self.assertNotIn("max_liquid_water", off.summary["diagnostics"])
        self.assertEqual(on.diagnostic("max_liquid_water")["max"], 0)
        stored = json.loads((off.out / "plan.json").read_text())["data_flow"]["stored"]
        self.assertNotIn("mass_fraction_of_cloud_liquid_water_in_air",
                         [one["name"] for one in stored])
        self.assertGreater(off.summary["watch"]["checks"], 0)

    def test_mixing_keeps_nothing_but_what_it_must(self):
        """Bytes per parcel: an exchange, a displacement and a stretching keep nothing; Langevin
        velocities are three numbers and a weight, the size of a grown parcel is one."""
        thermal = CONFIGS / "moist_thermal"

        def stored(variant, *settings):
            plan = plan_of(thermal / f"moist_thermal{variant}.yaml", *settings)
            return plan["data_flow"]["bytes_per_parcel"]

        without = stored("")
        for variant in ("_nudged", "_overlap", "_stretched", "_coherent"):
            self.assertEqual(stored(variant), without, variant)
        self.assertEqual(stored("_langevin", "--set", "operators.displacement.model=brownian"),
                         without)
        self.assertEqual(stored("_langevin"), without + 4 * 8)
        self.assertEqual(stored("_diluted"), without + 8)

    def test_watched_condensation_switches_on_and_equals_the_run_that_had_it(self):
        on = self.run_well(BUBBLE, out="on", values=MOIST | {"effects.condensation": "on"})
        watched = self.run_well(BUBBLE, out="watched",
                                values=MOIST | {"effects.condensation": "watch"})
        effect = watched.summary["effects"]["condensation"]
        self.assertEqual(effect["verdict"], "watch")
        self.assertRegex(effect["reason"], r"switched on at t = [0-9.]+ s, step [1-9]")
        self.assertEqual(watched.summary["state_sha256"], on.summary["state_sha256"])
        self.assertGreater(on.diagnostic("max_liquid_water")["final"], 0)
        self.assertEqual(watched.diagnostic("max_liquid_water"), on.diagnostic("max_liquid_water"))

    def test_watched_condensation_survives_a_restart(self):
        values = MOIST | {"effects.condensation": "watch"}
        whole = self.run_well(BUBBLE, out="whole", values=values)
        self.run_well(BUBBLE, out="parts", values=values | {
            "time.max_steps": whole.summary["steps"] - 2})
        resumed = self.run_well(BUBBLE, out="parts", values=values,
                                options=("--threads", "2", "--resume"))
        self.assertEqual(resumed.summary["state_sha256"], whole.summary["state_sha256"])
        self.assertIn("switched on at", resumed.summary["effects"]["condensation"]["reason"])

    def test_a_scene_may_stop_where_an_effect_would_be_needed(self):
        scene = self.write("stop.yaml", f"extends: {BUBBLE}\n"
                           "effects: {condensation: {mode: watch, on_trip: stop}}\n")
        ended = self.run_scene(scene, values=MOIST)
        self.assert_refused(ended, NUMERICAL, "'condensation' was left out", "parcel",
                            "on_trip: activate")

    def test_unknown_effects_are_refused_before_anything_is_written(self):
        ended = self.run_scene(BUBBLE, values={"effects.condensatoin": "on"})
        self.assert_refused(ended, USAGE, "did you mean 'condensation'")
        self.assertFalse(ended.out.exists())

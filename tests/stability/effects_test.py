"""What is left out changes no bit: automatic plans against everything forced on."""
import json
import subprocess

from program import CONFIGS, NUMERICAL, PROGRAM, USAGE, ProgramTest, environment

BUBBLE = CONFIGS / "unsaturated_bubble" / "unsaturated_bubble_small.yaml"
# The bubble made so moist that its top saturates on the way, after some three minutes.
MOIST = {"constants.q_bubble": 0.0195, "time.end": "300 s", "output.fields.every": "300 s",
         "output.profiles.every": "300 s", "output.parcels.every": "300 s",
         "output.series.every": "50 s"}
LONGEST = 8  # steps compared where a scene's verdicts are all on: nothing to compare but the plan


def small_variants():
    """The quick scene of every folder, as `pileus check` chooses it."""
    for folder in sorted(CONFIGS.iterdir()):
        for ending in ("_small.yaml", ".yaml"):
            scene = folder / (folder.name + ending)
            if scene.is_file():
                yield scene
                break


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
        compared = 0
        for scene in small_variants():
            plan = plan_of(scene)
            if not plan["operators"]:
                continue  # nothing that could be left out
            with self.subTest(scene=scene.stem):
                left_out = [name for name, effect in plan["effects"].items()
                            if effect["provided_by"] and effect["verdict"] != "on"]
                values = {} if left_out else {"time.max_steps": LONGEST}
                planned = self.run_well(scene, out="auto_" + scene.stem, values=values)
                forced = self.run_well(self.forced_on(scene, plan), out="on_" + scene.stem,
                                       values=values)
                self.assertEqual(planned.summary["state_sha256"], forced.summary["state_sha256"])
                compared += 1
        self.assertGreater(compared, 0)

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

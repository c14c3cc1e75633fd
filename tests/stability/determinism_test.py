"""The same bits for any number of threads, and for every instruction set in itself."""
from program import CONFIGS, HEATED_GROUND, MIXING_THERMAL, RELAXING_THERMAL, THERMAL, WAVE, ProgramTest
from records import differences, parcel_records

# Coarse, and long enough for what can depend on threads to happen: the thermal splits and merges.
COARSE_WAVE = {"domain.cells": "[16, 16, 4]", "time.max_steps": 20}
COARSE_THERMAL = {"domain.cells": "[12, 12, 12]", "time.end": "420 s",
                  "output.fields.every": "100 s", "output.parcels.every": "70 s"}
SHORT_THERMAL = {"domain.cells": "[8, 8, 8]", "time.max_steps": 15}
COARSE_RELAXING_THERMAL = {"domain.cells": "[12, 12, 12]", "time.max_steps": 20}
COARSE_MIXING_THERMAL = {"domain.cells": "[10, 10, 10]", "time.max_steps": 12}


class Determinism(ProgramTest):

    def run_on(self, scene, values, threads, env=None):
        return self.run_well(scene, f"on_{threads}", values, ("--threads", str(threads), "--force"),
                             env)

    def assert_same_on_any_threads(self, scene, values):
        alone = self.run_on(scene, values, 1)
        for threads in (2, 3):
            many = self.run_on(scene, values, threads)
            self.assertEqual(many.summary["threads"], threads)
            self.assertEqual(many.summary["state_sha256"], alone.summary["state_sha256"])
            self.assertEqual(differences(alone.out, many.out), [])
            self.assertEqual(many.summary["diagnostics"], alone.summary["diagnostics"])
        return alone

    def test_wave_on_any_threads(self):
        alone = self.assert_same_on_any_threads(WAVE, COARSE_WAVE)
        self.assertEqual(alone.summary["steps"], 20)

    def test_thermal_on_any_threads(self):
        alone = self.assert_same_on_any_threads(THERMAL, COARSE_THERMAL)
        records = parcel_records(alone.out / "parcels.nc")
        self.assertTrue(records[-1] - records[0], "nothing was split")
        self.assertTrue(records[0] - records[-1], "nothing was merged")

    def test_operator_on_any_threads(self):
        alone = self.assert_same_on_any_threads(RELAXING_THERMAL, COARSE_RELAXING_THERMAL)
        self.assertNotEqual(alone.diagnostic("mean_passive_tracer")["relative_change"], 0)

    def test_operator_in_halves_on_any_threads(self):
        self.assert_same_on_any_threads(
            RELAXING_THERMAL, COARSE_RELAXING_THERMAL | {"coupling.scheme": "strang"})

    def test_mixing_on_any_threads(self):
        self.assert_same_on_any_threads(MIXING_THERMAL, COARSE_MIXING_THERMAL)

    def test_mixing_in_halves_on_any_threads(self):
        self.assert_same_on_any_threads(
            MIXING_THERMAL, COARSE_MIXING_THERMAL | {"coupling.scheme": "strang"})

    def test_ground_on_any_threads(self):
        self.assert_same_on_any_threads(HEATED_GROUND, {"time.end": "200 s"})

    def test_mixing_of_strength_zero_changes_no_bit(self):
        """Nor does an operator that reads the mesh leave a trace in what the core keeps there."""
        values = {"domain.cells": "[10, 10, 10]", "time.max_steps": 12}

        def state(scene, **more):
            return self.run_on(scene, values | more, 2).summary["state_sha256"]

        without = state(THERMAL)
        for variant, strength in (("nudged", "mixing.beta"), ("overlap", "exchange.rate"),
                                  ("stretched", "stretching.coefficient"),
                                  ("coherent", "displacement.smagorinsky")):
            scene = CONFIGS / "moist_thermal" / f"moist_thermal_{variant}.yaml"
            self.assertEqual(state(scene, **{f"operators.{strength}": 0}), without, variant)
            self.assertNotEqual(state(scene), without, variant)

    def test_fields_of_formulas_on_many_threads(self):
        """Parsers of formulas share what they are made from: threads used to corrupt it at times."""
        hashes = {self.run_on(THERMAL, {"domain.cells": "[8, 8, 8]", "time.max_steps": 0,
                                        "time.end": "0 s"}, threads).summary["state_sha256"]
                  for threads in [1] + 12 * [4]}
        self.assertEqual(len(hashes), 1)

    def test_other_state_other_hash(self):
        """The hash sees a change in the last place of one scalar of one parcel."""
        hashes = set()
        for buoyancy in ("1e-3", "'1e-3 + (min(x, y, z) > 5400 ? 3e-19 : 0)'"):
            ended = self.run_on(WAVE, {"domain.extent": "6280 m", "domain.cells": "[4, 4, 4]",
                                       "domain.lower": "0 m", "time.max_steps": 0,
                                       "time.end": "0 s", "initial.buoyancy": buoyancy}, 1)
            hashes.add(ended.summary["state_sha256"])
        self.assertEqual(len(hashes), 2)

    def test_instruction_sets(self):
        """Wider vectors may round differently; each must agree with itself on any threads."""
        for instructions in ("baseline", "avx2"):
            env = {"PILEUS_INSTRUCTION_SET": instructions}
            runs = [self.run_on(THERMAL, SHORT_THERMAL, threads, env)
                    for threads in (1, 2, 1)]
            self.assertEqual(len({run.summary["state_sha256"] for run in runs}), 1, instructions)

"""Superdroplets in a whole run: the same bits on any number of threads, after a kill, and with the
skipping of idle parcels off; water is accounted for to the last place."""
import time

from program import CONFIGS, SOURCE, ProgramTest
from records import differences

CLOUD = CONFIGS / "lee_cloud" / "lee_cloud.yaml"
BUSY = {"domain.cells": "[20, 20]", "time.end": "900 s", "output.checkpoint.steps": 20,
        "operators.droplets.superdroplets_per_parcel": 8, "operators.droplets.aerosol_number": 3e7,
        "operators.collisions.kernel": "golovin",  # rain within minutes
        "operators.collisions.golovin_coefficient": 2e5,
        "output.fields.every": "300 s", "output.parcels.every": "300 s",
        "output.spectra.every": "300 s", "output.droplets.every": "300 s",
        "output.droplets.fraction": 0.5, "output.series.every": "30 s"}
FILES = ("fields.nc", "parcels.nc", "profiles.nc", "series.nc", "spectra.nc", "droplets.nc")


class Superdroplets(ProgramTest):

    def assert_rained(self, ended):
        self.assertGreater(ended.diagnostic("mean_rainfall_amount")["max"], 1e-3)
        self.assertLess(ended.diagnostic("water_budget_defect")["max"], 1e-12)
        self.assertLess(ended.diagnostic("dry_aerosol_budget_defect")["max"], 1e-12)
        self.assertGreater(ended.diagnostic("parcels")["max"],
                           ended.diagnostic("parcels")["initial"], "nothing was split")

    def test_on_any_threads(self):
        alone = self.run_well(CLOUD, "alone", BUSY, ("--threads", "1"))
        self.assert_rained(alone)
        for threads in (2, 3):
            many = self.run_well(CLOUD, f"on_{threads}", BUSY, ("--threads", str(threads)))
            self.assertEqual(many.summary["state_sha256"], alone.summary["state_sha256"])
            self.assertEqual(differences(alone.out, many.out, FILES), [])

    def test_with_skipping_off(self):
        skipping = self.run_well(CLOUD, "skipping", BUSY)
        complete = self.run_well(CLOUD, "complete", BUSY | {"coupling.skip_inactive": "no"})
        self.assertEqual(complete.summary["state_sha256"], skipping.summary["state_sha256"])
        self.assertEqual(complete.summary["diagnostics"], skipping.summary["diagnostics"])

    def test_killed_run_resumes_bit_by_bit(self):
        whole = self.run_well(CLOUD, "whole", BUSY)
        process = self.start_scene(CLOUD, "killed", BUSY)
        while process.poll() is None and not list((self.folder / "killed").glob("checkpoint_*.h5")):
            time.sleep(0.01)
        process.kill()
        process.wait()
        resumed = self.run_well(CLOUD, "killed", BUSY, ("--threads", "2", "--resume"))
        self.assertEqual(resumed.summary["state_sha256"], whole.summary["state_sha256"])
        self.assertEqual(differences(whole.out, resumed.out, FILES), [])
        self.assert_rained(whole)

    def test_same_seed_same_droplets(self):
        first = self.run_well(CLOUD, "first", BUSY | {"time.end": "100 s"})
        again = self.run_well(CLOUD, "again", BUSY | {"time.end": "100 s"})
        other = self.run_well(CLOUD, "other", BUSY | {"time.end": "100 s", "scene.seed": 5})
        self.assertEqual(first.summary["state_sha256"], again.summary["state_sha256"])
        self.assertNotEqual(first.summary["state_sha256"], other.summary["state_sha256"])

    def test_a_checkpoint_of_other_droplets_cannot_be_continued(self):
        values = BUSY | {"time.end": "100 s"}
        self.run_well(CLOUD, "run", values)
        scene = self.write("without.yaml", CLOUD.read_text().split("  - use: org.pileus.superdroplets.sed")[0]
                           .replace("extends: air.yaml", f"extends: {CLOUD.parent / 'air.yaml'}"))
        ended = self.run_scene(scene, "run", {k: v for k, v in values.items()
                                              if "fall" not in k}, ("--resume",))
        self.assertEqual(ended.code, 5)
        self.assertIn("height_within_parcel", ended.text)

    def test_air_that_has_rained_out_resumes_bit_by_bit(self):
        """Lists without a single item are lists still, after a restart too."""
        scene = SOURCE / "configs" / "hard" / "drops_through_thin_cells.yaml"
        values = {"domain.cells": "[2, 20]", "constants.steps": 80, "output.checkpoint.steps": 60,
                  "operators.droplets.superdroplets_per_parcel": 1}
        whole = self.run_well(scene, "whole", values)
        self.assertEqual(whole.diagnostic("items")["final"], 0)
        first = self.run_well(scene, "parts", values | {"time.max_steps": 61})
        self.assertEqual(first.summary["steps"], 61)
        resumed = self.run_well(scene, "parts", values, ("--resume",))
        self.assertEqual(resumed.summary["state_sha256"], whole.summary["state_sha256"])

    def test_droplets_without_condensation_only_ride_along(self):
        for effects in ({"effects.condensation": "off"}, {"operators.droplets.condensation": "no"}):
            ended = self.run_well(CLOUD, "off", BUSY | {"time.end": "60 s"} | effects,
                                  ("--threads", "1", "--force"))
            water = ended.diagnostic("total_droplet_water_mass")
            self.assertGreater(water["initial"], 0)
            self.assertEqual(water["final"], water["initial"])

    def test_a_run_replaces_all_files_of_the_last_one(self):
        short = BUSY | {"time.end": "10 s"}
        for _ in range(2):
            ended = self.run_well(CLOUD, "again", short, ("--threads", "1", "--force"))
        self.assertTrue((ended.out / "droplets.nc").exists())

"""What no run may change, whatever the scene."""
from program import HEATED_GROUND, MIXING_THERMAL, THERMAL, WAVE, WARM_BUBBLE_2D, ProgramTest

# Means over n parcels round by at most n times the unit round-off, here 14 000 times 1.1e-16; the
# means of pairwise merges and halvings add less.
CONSERVED = 2e-12
COARSE_THERMAL = {"domain.cells": "[12, 12, 12]", "time.end": "450 s"}
CARRIED = ("liquid_water_buoyancy", "total_water_mass_fraction")


class Conservation(ProgramTest):

    def assert_mean_kept(self, ended, name):
        values = ended.diagnostic(name)
        for statistic in ("final", "min", "max"):
            self.assertLessEqual(abs(values[statistic] - values["initial"]),
                                 CONSERVED * abs(values["initial"]), f"{name} {statistic}")

    def assert_never_widened(self, ended, quantity):
        """Not by one unit in the last place: a mean of values lies between them."""
        low, high = ended.diagnostic(f"min_{quantity}"), ended.diagnostic(f"max_{quantity}")
        self.assertEqual(low["min"], low["initial"], quantity)
        self.assertEqual(high["max"], high["initial"], quantity)

    def test_thermal(self):
        ended = self.run_well(THERMAL, values=COARSE_THERMAL)
        self.assertNotEqual(ended.summary["parcels"]["initial"], ended.summary["parcels"]["final"])
        self.assertGreater(ended.diagnostic("max_liquid_water")["final"], 0)
        for name in ("volume", "total_water", *(f"mean_{quantity}" for quantity in CARRIED)):
            self.assert_mean_kept(ended, name)
        for quantity in CARRIED:
            self.assert_never_widened(ended, quantity)

    def test_ground(self):
        """Flux times time over the height, through splits and mergers; to 1e-10 of what came."""
        ended = self.run_well(HEATED_GROUND)
        self.assertNotEqual(ended.summary["parcels"]["initial"], ended.summary["parcels"]["final"])
        for name, came in (("liquid_water_potential_temperature", 0.3 * 600 / 800),
                           ("total_water_mass_fraction", 1e-4 * 600 / 800)):
            mean = ended.diagnostic(f"mean_{name}")
            self.assertAlmostEqual((mean["final"] - mean["initial"]) / came, 1, delta=1e-10)

    def test_mixing(self):
        """Nudging, exchange, displaced, stretched and growing parcels: amounts and extrema as
        without, and the variance that has gone is what operators and mergers took."""
        ended = self.run_well(MIXING_THERMAL, values=COARSE_THERMAL)
        self.assertNotEqual(ended.summary["parcels"]["initial"], ended.summary["parcels"]["final"])
        for name in ("volume", "total_water", *(f"mean_{quantity}" for quantity in CARRIED)):
            self.assert_mean_kept(ended, name)
        for quantity in CARRIED:
            low, high = ended.diagnostic(f"min_{quantity}"), ended.diagnostic(f"max_{quantity}")
            self.assertGreaterEqual(low["min"], low["initial"], quantity)
            self.assertLessEqual(high["max"], high["initial"], quantity)
        variance, operators, mergers = (
            ended.diagnostic(f"total_water_mass_fraction_variance{part}")
            for part in ("", "_lost_to_operators", "_lost_to_mergers"))
        lost = operators["final"] + mergers["final"]
        self.assertAlmostEqual((variance["initial"] - variance["final"]) / lost, 1, delta=1e-9)
        self.assertGreater(operators["final"], 0)
        self.assertGreater(mergers["final"], 0)

    def test_wave(self):
        ended = self.run_well(WAVE, values={"domain.cells": "[16, 16, 4]"})
        self.assert_mean_kept(ended, "volume")
        self.assert_never_widened(ended, "buoyancy")

    def test_bubble_in_the_plane(self):
        ended = self.run_well(WARM_BUBBLE_2D, values={"domain.cells": "[24, 24]",
                                                      "time.end": "600 s"})
        self.assertNotEqual(ended.summary["parcels"]["initial"], ended.summary["parcels"]["final"])
        for name in ("volume", "mean_buoyancy"):
            self.assert_mean_kept(ended, name)
        self.assert_never_widened(ended, "buoyancy")

    def test_mean_wind_stays(self):
        """Walls without friction take no momentum, and buoyancy gives none sideways."""
        ended = self.run_well(THERMAL, values=COARSE_THERMAL | {
            "initial.mean_wind": "[3 m/s, -2 m/s]", "time.max_steps": 20})
        for name, wind in (("mean_wind_x", 3), ("mean_wind_y", -2)):
            values = ended.diagnostic(name)
            self.assertEqual((values["min"], values["max"]), (wind, wind))

    def test_wind_carries_the_thermal_along(self):
        """A uniform wind is a change of the observer: what is seen of the cloud stays."""
        values = {"domain.cells": "[16, 16, 16]"}
        still = self.run_well(THERMAL, "still", values, ("--threads", "2"))
        windy = self.run_well(THERMAL, "windy", values | {"initial.mean_wind": "[5 m/s, 5 m/s]"},
                              ("--threads", "2"))
        for name, allowed in (("cloud_fraction", 0.02), ("mean_liquid_water", 0.03)):
            a, b = still.diagnostic(name)["final"], windy.diagnostic(name)["final"]
            self.assertGreater(a, 0)
            self.assertLessEqual(abs(b / a - 1), allowed, name)

"""Runs at the edges of what a scene may say."""
from program import SCENES, THERMAL, WARM_BUBBLE_2D, ProgramTest
from records import read

BUBBLE = SCENES / "still_air.yaml"
# Sums over n parcels round by at most n times the unit round-off; n is below 4500 here.
CONSERVED = 1e-12


class EdgeCases(ProgramTest):

    def assert_conserves(self, ended):
        for name in ("volume", "mean_buoyancy"):
            values = ended.diagnostic(name)
            for statistic in ("final", "min", "max"):
                self.assertLessEqual(abs(values[statistic] - values["initial"]),
                                     CONSERVED * abs(values["initial"]), f"{name} {statistic}")

    def test_no_time_at_all(self):
        ended = self.run_well(BUBBLE, values={"time.end": "0 s"})
        self.assertEqual(ended.summary["steps"], 0)
        self.assertEqual(ended.summary["simulated_time_s"], 0)
        self.assertEqual(list(read(ended.out / "series.nc", "time")), [0])

    def test_end_before_the_first_step_would(self):
        """One step, shortened to end in time."""
        ended = self.run_well(BUBBLE, values={
            "time.end": "1e-3 s", "output.fields.every": "1 s", "output.parcels.every": "1 s"})
        self.assertEqual(ended.summary["steps"], 1)
        self.assertEqual(ended.summary["simulated_time_s"], 1e-3)
        self.assertEqual(list(read(ended.out / "fields.nc", "time")[[0, -1]]), [0, 1e-3])

    def test_record_of_every_step(self):
        every = {f"output.{stream}.every": "2 s"
                 for stream in ("fields", "parcels", "profiles", "series")}
        ended = self.run_well(BUBBLE, values=every | {"time.step.largest": "2 s",
                                                      "time.end": "20 s"})
        for file in ("fields.nc", "profiles.nc", "series.nc"):
            times = read(ended.out / file, "time")
            self.assertEqual(len(times), ended.summary["steps"] + 1, file)
            self.assertEqual(times[-1], 20)
        self.assert_conserves(ended)

    def test_smallest_meshes(self):
        for cells in ("[2, 2, 2]", "[1, 1, 1]", "[1, 1, 4]", "[4, 4, 1]"):
            with self.subTest(cells):
                self.assert_conserves(
                    self.run_well(BUBBLE, values={"domain.cells": cells}, options=("--force",)))

    def test_odd_and_thin_meshes(self):
        for cells in ("[7, 5, 9]", "[8, 1, 8]", "[1, 8, 8]"):
            with self.subTest(cells):
                self.assert_conserves(
                    self.run_well(BUBBLE, values={"domain.cells": cells}, options=("--force",)))

    def test_parcels_per_cell(self):
        for per_cell in (1, 27, 64):
            with self.subTest(per_cell):
                ended = self.run_well(BUBBLE, values={"parcels.per_cell": per_cell},
                                      options=("--force",))
                self.assertEqual(ended.summary["parcels"]["initial"], 64 * per_cell)
                self.assert_conserves(ended)

    def test_bubble_in_the_plane(self):
        ended = self.run_well(WARM_BUBBLE_2D)
        self.assertEqual(ended.summary["dimension"], 2)
        self.assertGreater(ended.diagnostic("max_vertical_velocity")["final"], 1)
        self.assert_conserves(ended)

    def test_more_threads_than_parcels(self):
        self.assert_conserves(self.run_well(
            BUBBLE, values={"domain.cells": "[1, 1, 1]", "parcels.per_cell": 1},
            options=("--threads", "16")))

    def test_no_streams(self):
        off = {f"output.{stream}.every": "0 s" for stream in ("fields", "parcels", "profiles")}
        ended = self.run_well(THERMAL, values=off | {"domain.cells": "[4, 4, 4]",
                                                     "time.max_steps": 3})
        self.assertEqual(sorted(path.name for path in ended.out.glob("*.nc")), ["series.nc"])

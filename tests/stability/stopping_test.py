"""Stopping on request, and going on from there or from a run's end."""
import signal
import time

from program import DONE, FILE, STOPPED, USAGE, THERMAL, ProgramTest
from records import differences, read

VALUES = {"domain.cells": "[8, 8, 8]", "time.end": "300 s", "output.fields.every": "50 s",
          "output.parcels.every": "100 s", "output.profiles.every": "20 s",
          "output.series.every": "5 s"}
RESUME = ("--threads", "1", "--resume")


class Stopping(ProgramTest):

    def stop(self, number):
        process = self.start_scene(THERMAL, "stopped", VALUES)
        while process.poll() is None and not (self.folder / "stopped" / "fields.nc").exists():
            time.sleep(0.001)
        process.send_signal(number)
        return process.wait()

    def test_stop_signals(self):
        """A checkpoint, exit code 75, and the resumed run equals the one that was let be."""
        whole = self.run_well(THERMAL, "whole", VALUES)
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number):
                self.assertEqual(self.stop(number), STOPPED)
                self.assertEqual(len(list((self.folder / "stopped").glob("checkpoint_*.h5"))), 1)
                resumed = self.run_well(THERMAL, "stopped", VALUES, RESUME)
                self.assertEqual(resumed.summary["state_sha256"], whole.summary["state_sha256"])
                self.assertEqual(differences(whole.out, resumed.out), [])
            for path in (self.folder / "stopped").iterdir():
                path.unlink()

    def test_finished_run_is_extended(self):
        """With intervals of its own, the extended run is the longer run."""
        whole = self.run_well(THERMAL, "whole", VALUES)
        self.run_well(THERMAL, "extended", VALUES | {"time.end": "200 s"})
        extended = self.run_well(THERMAL, "extended", VALUES, RESUME)
        self.assertEqual(extended.summary["state_sha256"], whole.summary["state_sha256"])
        self.assertEqual(extended.summary["diagnostics"], whole.summary["diagnostics"])
        self.assertEqual([line for line in differences(whole.out, extended.out)
                          if "attributes" not in line and "scene" not in line], [])

    def test_finished_run_resumed_is_itself(self):
        first = self.run_well(THERMAL, "results", VALUES)
        before = first.summary
        series = read(first.out / "series.nc", "time").tobytes()
        again = self.run_well(THERMAL, "results", VALUES, RESUME)
        for same in ("state_sha256", "steps", "diagnostics", "outputs"):
            self.assertEqual(again.summary[same], before[same], same)
        self.assertEqual(read(again.out / "series.nc", "time").tobytes(), series)

    def test_results_without_a_checkpoint_are_kept(self):
        first = self.run_well(THERMAL, "results", VALUES)
        for path in first.out.glob("checkpoint_*.h5"):
            path.unlink()
        before = (first.out / "fields.nc").read_bytes()
        self.assert_refused(self.run_scene(THERMAL, "results", VALUES, RESUME), FILE,
                            "no checkpoint", "--force", "--out")
        self.assertEqual((first.out / "fields.nc").read_bytes(), before)

    def test_resume_in_an_empty_folder_begins(self):
        self.assertEqual(self.run_scene(THERMAL, "new", VALUES, RESUME).code, DONE)

    def test_checkpoint_of_another_domain(self):
        self.run_well(THERMAL, "results", VALUES)
        for change in ({"domain.extent": "6000 m"}, {"domain.cells": "[8, 8, 9]"}):
            with self.subTest(change):
                self.assert_refused(
                    self.run_scene(THERMAL, "results", VALUES | change | {"time.end": "320 s"},
                                   RESUME), USAGE, "another domain or mesh")

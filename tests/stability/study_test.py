"""Studies seen from outside: stopped and continued, with a run that breaks down, and chosen from."""
import csv
import json
import signal
import subprocess
import time

from program import DONE, LIMIT, PROGRAM, STOPPED, USAGE, WAVE, ProgramTest, environment

STUDY = """
scene: {scene}
set: {{domain.cells: [8, 8, 4], time.end: 1 s}}
knobs: [{{key: time.step.fixed, values: [{steps}]}}]
errors: [{{name: energy, diagnostic: total_energy, statistic: relative_change}}]
"""


class Studies(ProgramTest):

    def study(self, steps, name="study.yaml"):
        return self.write(name, STUDY.format(scene=WAVE, steps=steps))

    def start_study(self, path, *options):
        return subprocess.Popen([PROGRAM, "study", str(path), "--no-pictures", "--out",
                                 str(self.folder / "out"), *options],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                env=environment())

    def run_study(self, path, code, *options):
        process = self.start_study(path, *options)
        words, _ = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, code, words)
        return words

    def points(self):
        with (self.folder / "out" / "study.csv").open(encoding="utf-8") as table:
            return list(csv.DictReader(table))

    def outcomes(self):
        return {path: json.loads(path.read_text())["date"]
                for path in (self.folder / "out" / "points").glob("*/repeat_*.json")}

    def test_stopped_study_goes_on(self):
        """Exit code 75; what was finished is not made again, what was not is."""
        study = self.study("0.1, 2e-5")  # the second takes far longer than the test
        process = self.start_study(study)
        while process.poll() is None and not self.outcomes():
            time.sleep(0.01)
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        words, _ = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, STOPPED, words)
        self.assertFalse((self.folder / "out" / "study.csv").exists())
        first = self.outcomes()
        self.assertEqual(len(first), 1)
        self.run_study(self.study("0.1, 0.2"), DONE)
        self.assertEqual(self.outcomes() | first, self.outcomes())
        self.assertEqual([row["label"] for row in self.points()], ["0.1", "0.2"])

    def test_a_run_that_breaks_down_does_not_end_the_study(self):
        """A step of 1e-30 s is lost in the rounding of the end's time; the other run is judged."""
        words = self.run_study(self.study("0.1, 1e-30"), DONE)
        self.assertIn("failed: 1e-30: exit code 4", words)
        rows = self.points()
        self.assertTrue(rows[0]["error_energy"])
        self.assertFalse(rows[1]["error_energy"])

    def test_mistakes_leave_nothing_behind(self):
        for steps, word in (("0.1, -1", "study.yaml:4:46"), ("0.1, fast", "study.yaml:4:46")):
            words = self.run_study(self.study(steps), USAGE)
            self.assertIn(word, words)
            self.assertFalse((self.folder / "out").exists())

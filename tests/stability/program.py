"""The program seen from outside: runs of `pileus`, the folders they leave, and what is in them."""
import hashlib
import json
import os
import shutil
import subprocess
import unittest
from dataclasses import dataclass
from pathlib import Path

PROGRAM = os.environ["PILEUS_PROGRAM"]
SOURCE = Path(os.environ["PILEUS_SOURCE"])
WORK = Path(os.environ["PILEUS_WORK"])
ENDS_AT_WRITE = os.environ["PILEUS_ENDS_AT_WRITE"]  # what ends_at_write.c is built to

CONFIGS = SOURCE / "configs" / "scenes"
SCENES = SOURCE / "tests" / "scenes"
WAVE = CONFIGS / "internal_wave" / "internal_wave_small.yaml"
THERMAL = CONFIGS / "moist_thermal" / "moist_thermal_small.yaml"
RELAXING_THERMAL = SCENES / "relaxing_thermal.yaml"
MIXING_THERMAL = SCENES / "mixing_thermal.yaml"
HEATED_GROUND = SCENES / "heated_ground.yaml"
WARM_BUBBLE_2D = SCENES / "warm_bubble_2d.yaml"

# Exit codes, as `pileus --help` promises them.
DONE, USAGE, PLUGIN, NUMERICAL, FILE, STOPPED = 0, 2, 3, 4, 5, 75
LIMIT = 60  # s; nothing here takes a tenth of it on a quiet machine


@dataclass
class Ended:
    """A run that is over: exit code (negative: the signal that ended it) and what it wrote."""

    code: int
    text: str
    out: Path

    @property
    def summary(self):
        return json.loads((self.out / "summary.json").read_text())

    def diagnostic(self, name):
        return self.summary["diagnostics"][name]


def settings(values):
    """{'time.end': 3} as the command line wants it."""
    return [word for key, value in values.items() for word in ("--set", f"{key}={value}")]


def environment(**extra):
    """Idle threads sleep, so that more threads than cores cost little; no plugins of the caller. A
    program with AddressSanitizer accepts libraries that are loaded before it."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith("PILEUS_")}
    sanitizer = f"{kept.get('ASAN_OPTIONS', '')}:verify_asan_link_order=0"
    return (kept | {"OMP_WAIT_POLICY": "passive", "ASAN_OPTIONS": sanitizer}
            | {k: str(v) for k, v in extra.items()})


class ProgramTest(unittest.TestCase):
    """Gives every test an empty folder and ways to run the program in it."""

    maxDiff = 2000

    def setUp(self):
        self.folder = WORK / self.id().split(".", 1)[-1]
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)

    def tearDown(self):
        outcome = getattr(self._outcome, "result", None)
        failed = outcome and any(
            case is self for case, _ in outcome.failures + outcome.errors)
        if not failed:  # what a failure left is worth a look
            shutil.rmtree(self.folder, ignore_errors=True)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def command(self, scene, out, values, options):
        return [PROGRAM, "run", str(scene), "--quiet", "--out", str(out), *options,
                *settings(values)]

    def run_scene(self, scene, out="results", values=None, options=("--threads", "1"), env=None,
                  **how):
        """Runs to the end and returns what came of it, whatever that is."""
        out = self.folder / out
        ended = subprocess.run(
            self.command(scene, out, values or {}, options), env=environment(**(env or {})),
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=LIMIT,
            cwd=self.folder, errors="replace", check=False, **how)
        return Ended(ended.returncode, ended.stdout, out)

    def run_well(self, *arguments, **named):
        """Runs to the end, which must be a good one."""
        ended = self.run_scene(*arguments, **named)
        self.assertEqual(ended.code, DONE, ended.text)
        return ended

    def start_scene(self, scene, out="results", values=None, options=("--threads", "1")):
        """Starts a run and returns its process, for the test to disturb."""
        log = (self.folder / "log").open("a")
        self.addCleanup(log.close)
        process = subprocess.Popen(
            self.command(scene, self.folder / out, values or {}, options), env=environment(),
            stdout=log, stderr=subprocess.STDOUT, cwd=self.folder)
        self.addCleanup(lambda: process.poll() is None and (process.kill(), process.wait()))
        return process

    def assert_refused(self, ended, code, *phrases):
        """The exit code, and every phrase somewhere in the message; no trace of a crash."""
        self.assertEqual(ended.code, code, ended.text)
        for phrase in phrases:
            self.assertIn(phrase, ended.text)
        self.assertNotIn("this should not happen", ended.text)


def contents(folder):
    """{path: digest} of everything below a folder."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(Path(folder).rglob("*")) if path.is_file()
    }

"""A run that was killed and resumed is the run that was not."""
import random
import signal
import time

from program import (DONE, ENDS_AT_WRITE, HEATED_GROUND, MIXING_THERMAL, RELAXING_THERMAL, THERMAL,
                     WAVE, ProgramTest)
from records import differences

# A checkpoint every third step and a record of every stream in most steps: a large share of the
# time goes into writing, so that kills at random meet it.
BUSY = {"output.checkpoint.steps": 3, "output.fields.every": "15 s",
        "output.parcels.every": "30 s", "output.profiles.every": "10 s",
        "output.series.every": "5 s"}
BUSY_THERMAL = BUSY | {"domain.cells": "[10, 10, 10]", "time.end": "420 s"}
BUSY_RELAXING_THERMAL = BUSY | {"domain.cells": "[8, 8, 8]", "time.end": "360 s"}
# Without a cap on the step: its length depends on the flow, to the last bit.
BUSY_WAVE = {"domain.cells": "[16, 16, 4]", "time.end": "4", "output.checkpoint.steps": 2,
             "output.fields.every": "0.4", "output.parcels.every": "1",
             "output.profiles.every": "0.3", "output.series.every": "0.05"}
RESUME = ("--threads", "1", "--resume")
# An operator that takes one sub-step and asks for far shorter steps than the flow.
DISPLACED = """\
scene: {name: displaced, title: Parcels displaced by a random flow}
domain: {extent: [1 m, 1 m], cells: [8, 8]}
time: {end: 1 s, step: {largest: 0.2 s}}
initial: {buoyancy: '0.01*sin(2*pi*x)'}
operators:
  - {use: org.pileus.coherent_displacement, name: displacement, intensity: constant,
     diffusivity: 0.05 m2/s, substeps: 1}
output: {series: {every: 10 s}, checkpoint: {steps: 1}}
"""
MOST_KILLS = 40


def newest_step(folder):
    """The step of the newest checkpoint, 0 without one."""
    return max((int(path.stem.split("_")[1]) for path in folder.glob("checkpoint_*.h5")), default=0)


def merges_counted(ended):
    return ended.summary["phases"]["merge"]["calls"]


class Restart(ProgramTest):

    def assert_equal_runs(self, resumed, whole):
        self.assertEqual(resumed.summary["state_sha256"], whole.summary["state_sha256"])
        self.assertEqual(resumed.summary["status"], "done")
        for same in ("steps", "simulated_time_s", "parcels", "diagnostics", "expect", "budgets"):
            self.assertEqual(resumed.summary[same], whole.summary[same], same)
        # Times are those of all sessions together: every step merges once.
        self.assertEqual(merges_counted(resumed), merges_counted(whole))
        self.assertEqual(differences(whole.out, resumed.out), [])
        leftovers = [path.name for path in resumed.out.iterdir()
                     if path.suffix in (".tmp", ".journal", ".lock")]
        self.assertEqual(leftovers, [])

    def timed(self, scene, values):
        """An uninterrupted run, and how long it takes (s) on the machine as it is now."""
        begin = time.monotonic()
        whole = self.run_well(scene, "whole", values)
        return whole, time.monotonic() - begin

    def kill_and_resume(self, scene, values, moments):
        """Kills the run at each of the moments, a function of the process and its folder that
        returns when it is time, then lets it finish."""
        options, killed = ("--threads", "1"), 0
        for wait_for_moment in moments:
            process = self.start_scene(scene, "killed", values, options)
            wait_for_moment(process, self.folder / "killed")
            process.kill()
            if process.wait() == DONE:
                break
            killed += 1
            options = RESUME
        self.assertGreater(killed, 0, "every run was over before it could be killed")
        return self.run_well(scene, "killed", values, RESUME), killed

    def random_moments(self, seed, took):
        """Random times after which to kill, short against the run so that it takes several."""
        chance = random.Random(seed)
        for _ in range(MOST_KILLS):
            yield lambda process, folder: time.sleep(chance.uniform(0.05, 0.25) * took)

    def test_thermal_killed_once_at_random(self):
        whole, took = self.timed(THERMAL, BUSY_THERMAL)
        steps = whole.summary["steps"]
        for seed in range(4):
            chance = random.Random(seed)
            step, moment = chance.randrange(0, steps // 2), chance.uniform(0, 5 / steps) * took

            def after_step(process, folder, step=step, moment=moment):
                while process.poll() is None and newest_step(folder) < step:
                    time.sleep(0.001)
                time.sleep(moment)

            with self.subTest(seed=seed, step=step):
                resumed, _ = self.kill_and_resume(THERMAL, BUSY_THERMAL, [after_step])
                self.assert_equal_runs(resumed, whole)
            self.empty("killed")

    def test_wave_killed_again_and_again(self):
        whole, took = self.timed(WAVE, BUSY_WAVE)
        resumed, killed = self.kill_and_resume(WAVE, BUSY_WAVE, self.random_moments(5, took))
        self.assertGreater(killed, 1)
        self.assert_equal_runs(resumed, whole)

    def test_operators_killed_again_and_again(self):
        """In one pass and in symmetric halves, of which the checkpoint lies between two."""
        for coupling in ("lie", "strang"):
            values = BUSY_RELAXING_THERMAL | {"coupling.scheme": coupling}
            with self.subTest(coupling):
                whole, took = self.timed(RELAXING_THERMAL, values)
                resumed, killed = self.kill_and_resume(
                    RELAXING_THERMAL, values, self.random_moments(7, took))
                self.assertGreater(killed, 1)
                self.assert_equal_runs(resumed, whole)
            self.empty("killed", "whole")

    def test_mixing_killed_again_and_again(self):
        """Operators that read the mesh and draw random numbers."""
        values = BUSY_RELAXING_THERMAL | {"time.end": "180 s"}
        whole, took = self.timed(MIXING_THERMAL, values)
        resumed, _ = self.kill_and_resume(MIXING_THERMAL, values, self.random_moments(13, took))
        self.assert_equal_runs(resumed, whole)

    def test_ground_is_resumed(self):
        """What it owes, its maps and the step that its last fluxes ask for are in the checkpoint."""
        whole = self.run_well(HEATED_GROUND, "whole")
        self.run_scene(HEATED_GROUND, "stopped", {"time.max_steps": 20})
        resumed = self.run_well(HEATED_GROUND, "stopped", options=RESUME)
        for what in ("steps", "state_sha256"):
            self.assertEqual(resumed.summary[what], whole.summary[what])

    def test_limit_of_an_operator_is_remembered(self):
        """The step that an operator asked for before the run was interrupted still holds after."""
        scene = self.write("displaced.yaml", DISPLACED)
        whole = self.run_well(scene, "whole")
        self.assertGreater(whole.summary["steps"], 30)  # 5 by the flow alone
        self.run_scene(scene, "stopped", {"time.max_steps": 5})
        resumed = self.run_well(scene, "stopped", options=RESUME)
        for what in ("steps", "state_sha256"):
            self.assertEqual(resumed.summary[what], whole.summary[what])

    def test_killed_while_writing(self):
        """In the middle of a change of a file: every one of a stretch that holds a checkpoint, and
        some at random; also while what was left half done is being repaired."""
        values = BUSY_THERMAL | {"domain.cells": "[4, 4, 4]", "output.checkpoint.steps": 1}
        whole = self.run_well(THERMAL, "whole", values)
        chance = random.Random(11)
        first = chance.randint(60, 300)
        for change in [*range(first, first + 15), *(chance.randint(20, 600) for _ in range(10))]:
            with self.subTest(change=change):
                killed = self.run_ending_at(change, values, ("--threads", "1"))
                self.assertEqual(killed.code, -signal.SIGKILL, killed.text)
                self.run_ending_at(chance.randint(1, 12), values, RESUME)
                self.assert_equal_runs(self.run_well(THERMAL, "killed", values, RESUME), whole)
            self.empty("killed")

    def run_ending_at(self, change, values, options):
        return self.run_scene(THERMAL, "killed", values, options,
                              {"LD_PRELOAD": ENDS_AT_WRITE, "END_AT_WRITE": change})

    def test_killed_before_the_first_checkpoint(self):
        """Nothing was saved, so there is nothing to continue: the run says so and begins anew."""
        values = BUSY_THERMAL | {"output.checkpoint.steps": 100000}
        whole = self.run_well(THERMAL, "whole", values)
        resumed, _ = self.kill_and_resume(
            THERMAL, values, [lambda process, folder: self.wait_for(folder / "fields.nc")])
        self.assert_equal_runs(resumed, whole)

    def test_damaged_newest_checkpoint(self):
        """A checkpoint that the disk lost a piece of is passed over in favour of the one before."""
        whole = self.run_well(THERMAL, "whole", BUSY_THERMAL)
        before = self.stopped_half_way(THERMAL, BUSY_THERMAL)
        newest = max(before.glob("checkpoint_*.h5"))
        with newest.open("r+b") as file:
            file.seek(newest.stat().st_size // 2)
            file.write(b"\0" * 64)
        resumed = self.run_well(THERMAL, before.name, BUSY_THERMAL, RESUME)
        self.assertIn(newest.name, resumed.text)
        self.assert_equal_runs(resumed, whole)

    def stopped_half_way(self, scene, values):
        """A results folder of a run that was killed after two checkpoints."""
        process = self.start_scene(scene, "killed", values)
        folder = self.folder / "killed"
        while process.poll() is None and len(list(folder.glob("checkpoint_*.h5"))) < 2:
            time.sleep(0.001)
        process.kill()
        process.wait()
        return folder

    def wait_for(self, path):
        while not path.exists():
            time.sleep(0.001)

    def empty(self, *names):
        for name in names:
            for path in (self.folder / name).iterdir():
                path.unlink()

"""Sweeps seen from outside: with members that break down or are killed, stopped, continued, collected."""
import csv
import json
import os
import shutil
import signal
import subprocess
import time

import netCDF4
import numpy
import xarray

from program import (CONFIGS, DONE, FILE, LIMIT, NUMERICAL, PROGRAM, STOPPED, USAGE, WAVE,
                     ProgramTest, contents, environment)

SWEEP = """
scene: {scene}
set:
  domain.cells: [8, 8, 4]
  time.end: 1 s
  output.fields.every: 0
  output.parcels.every: 0
  output.profiles.every: {profiles}
  output.checkpoint.steps: 50
product: [{{key: time.step.fixed, values: [{steps}]}}, {{key: parcels.jitter, values: [{jitters}]}}]
"""
KILLED = 128 + signal.SIGKILL


class Sweeps(ProgramTest):

    def sweep(self, steps, jitters="0.2", profiles="0", more=""):
        text = SWEEP.format(scene=WAVE, steps=steps, jitters=jitters, profiles=profiles)
        return self.write("sweep.yaml", text + more)

    def start(self, path, *options, out="out"):
        return subprocess.Popen([PROGRAM, "sweep", str(path), "--jobs", "2", "--no-pictures",
                                 "--out", str(self.folder / out), *options],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                env=environment(), cwd=self.folder)

    def run_sweep(self, path, code, *options, out="out"):
        process = self.start(path, *options, out=out)
        words, _ = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, code, words)
        return words

    def member(self, index, out="out"):
        return self.folder / out / "members" / f"{index:04d}"

    def record(self, index, out="out"):
        path = self.member(index, out) / "member.json"
        return json.loads(path.read_text()) if path.exists() else {"status": "waiting"}

    def state(self, index, out="out"):
        return json.loads((self.member(index, out) / "summary.json").read_text())["state_sha256"]

    def wait_until(self, condition):
        end = time.monotonic() + LIMIT
        while not condition():
            self.assertLess(time.monotonic(), end, "it never came to that")
            time.sleep(0.01)

    def checkpoints(self, index):
        return sorted(self.member(index).glob("checkpoint_*.h5"))

    def test_members_that_break_down_or_are_killed_do_not_end_the_sweep(self):
        """A step of 1e-30 s is lost in the rounding of the end's time; the third is killed."""
        sweep = self.sweep("0.1, 1e-30, 4e-3, 0.05")
        process = self.start(sweep)
        self.wait_until(lambda: self.checkpoints(2))
        os.kill(int((self.member(2) / "run.lock").read_text().split()[0]), signal.SIGKILL)
        words, _ = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, KILLED, words)
        self.assertIn("2 of 4 members done, 2 failed", words)
        self.assertIn("member 0001 (fixed 1e-30, jitter 0.2) failed with exit code 4", words)
        self.assertIn("time step has become too small", words)
        self.assertIn("failure-state-", words)
        self.assertIn("member 0002 (fixed 4e-3, jitter 0.2) failed with exit code 137 (signal 9)",
                      words)
        self.assertTrue(self.checkpoints(2))
        first = self.record(0)
        words = self.run_sweep(sweep, NUMERICAL, "--resume")
        self.assertIn("3 of 4 members done, 1 failed", words)
        self.assertEqual(self.record(0), first)  # was not made again
        reference = self.run_well(WAVE, out="reference", values={
            "domain.cells": "[8, 8, 4]", "time.end": "1 s", "output.fields.every": 0,
            "output.parcels.every": 0, "time.step.fixed": 4e-3, "parcels.jitter": 0.2})
        self.assertEqual(self.state(2), reference.summary["state_sha256"])
        words = self.run_sweep(self.sweep("0.1, 0.2, 4e-3, 0.05"), DONE, "--resume")
        self.assertIn("4 of 4 members done", words)
        self.assertEqual(self.record(0), first)

    def test_a_plugin_that_crashes_is_named(self):
        """The operator and the phase stand among the last words of the member."""
        plugins = self.folder / "plugins"
        plugins.mkdir()
        shutil.copy(os.environ["PILEUS_CRASHING_LIBRARY"], plugins)
        sweep = self.write("sweep.yaml", f"""
scene: {CONFIGS / "taylor_green_2d" / "taylor_green_2d.yaml"}
set: {{domain.cells: [8, 8], time.max_steps: 2}}
list: [{{time.scheme: rk4}}, {{operators: [{{use: org.example.hostile}}]}}]
""")
        ended = subprocess.run(
            [PROGRAM, "sweep", str(sweep), "--out", str(self.folder / "out"), "--no-pictures"],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, timeout=LIMIT,
            env=environment(PILEUS_PLUGIN_PATH=plugins))
        self.assertNotEqual(ended.returncode, DONE)
        self.assertIn("1 of 2 members done, 1 failed", ended.stdout)
        self.assertRegex(ended.stdout, "pileus: fatal: SIG.* in plugin org.example.hostile, phase apply")

    def test_interrupted_sweep_goes_on_to_the_same_bits(self):
        sweep = self.sweep("0.1, 4e-3, 8e-3, 0.016")
        self.run_sweep(sweep, DONE, out="whole")
        process = self.start(sweep)
        self.wait_until(lambda: self.record(0)["status"] == "done" and self.checkpoints(1)
                        or process.poll() is not None)
        process.send_signal(signal.SIGINT)
        words, _ = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, STOPPED, words)
        self.assertIn("stopped; the same command continues", words)
        statuses = [self.record(index)["status"] for index in range(4)]
        self.assertEqual(statuses[0], "done")
        self.assertIn("stopped", statuses)
        self.assertTrue(self.checkpoints(statuses.index("stopped")))
        self.run_sweep(sweep, DONE)
        for index in range(4):
            self.assertEqual(self.state(index), self.state(index, "whole"))

    def test_collected_file_holds_what_numpy_finds(self):
        """Equal times: the file refers to the members' series; --copy and both engines agree."""
        sweep = self.sweep("0.1", jitters="0, 0.2, 0.4", profiles="0.5 s",
                           more="seeds: [3, 5]\nseed_keys: [parcels.seed]\n")
        self.run_sweep(sweep, DONE)
        path = self.folder / "out" / "ensemble.nc"
        members = [netCDF4.Dataset(self.member(index) / "series.nc") for index in range(6)]
        energy = numpy.array([member["kinetic_energy"][:] for member in members])
        for engine in ("netcdf4", "h5netcdf"):
            with xarray.open_dataset(path, engine=engine) as ensemble:
                self.assertEqual(dict(ensemble["kinetic_energy"].sizes),
                                 {"member": 6, "time": energy.shape[1]})
                for name in ("jitter", "seed", "status", "wall_time"):
                    self.assertIn(name, ensemble["kinetic_energy"].coords)
                self.assertEqual(list(ensemble["jitter"].values), [0, 0, 0.2, 0.2, 0.4, 0.4])
                self.assertEqual(list(ensemble["member"].values), list(range(6)))
                self.assertEqual(list(ensemble["seed"].values), [3, 5, 3, 5, 3, 5])
                for name in ("member", "seed"):
                    self.assertEqual(ensemble[name].dtype.kind, "i", name)
                self.assertEqual(set(ensemble["status"].values), {"done"})
                self.assertTrue((ensemble["kinetic_energy"].values == energy).all())
                numpy.testing.assert_allclose(ensemble["kinetic_energy_mean"], energy.mean(axis=0),
                                              rtol=1e-14)
                numpy.testing.assert_allclose(ensemble["kinetic_energy_std"], energy.std(axis=0),
                                              rtol=1e-9, atol=1e-14 * energy.max())
                for percent in (5, 25, 50, 75, 95):
                    numpy.testing.assert_allclose(ensemble[f"kinetic_energy_p{percent:02d}"],
                                                  numpy.percentile(energy, percent, axis=0),
                                                  rtol=1e-13)
                profile = ensemble["profile_buoyancy"]
                self.assertEqual(profile.dims, ("member", "profile_time", "z"))
                numpy.testing.assert_allclose(ensemble["profile_buoyancy_mean"],
                                              profile.mean("member"), rtol=1e-12, atol=1e-15)
                referred = ensemble.load()
        for member in members:
            member.close()
        self.run_sweep(sweep, DONE, "--collect", "--copy")
        for index in range(6):
            (self.member(index) / "series.nc").rename(self.member(index) / "moved.nc")
        with xarray.open_dataset(path) as copied:
            self.assertTrue((copied["kinetic_energy"] == referred["kinetic_energy"]).all())

    def test_members_of_different_times_meet_on_common_ones(self):
        self.run_sweep(self.sweep("0.03, 0.1", more="list: [{output.series.every: 0.25 s}]\n"), DONE)
        with xarray.open_dataset(self.folder / "out" / "ensemble.nc") as ensemble:
            seconds = (ensemble["time"].values - numpy.datetime64("2000-01-01")
                       ) / numpy.timedelta64(1, "s")
            numpy.testing.assert_allclose(seconds, [0, 0.25, 0.5, 0.75, 1])
            for index in range(2):
                with netCDF4.Dataset(self.member(index) / "series.nc") as member:
                    expected = numpy.interp(seconds, member["time"][:], member["kinetic_energy"][:])
                numpy.testing.assert_allclose(ensemble["kinetic_energy"][index], expected,
                                              rtol=1e-13)

    def test_tables_name_settings_and_results(self):
        self.run_sweep(self.sweep("0.1, 0.2"), DONE)
        with (self.folder / "out" / "members.csv").open(encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        for index, row in enumerate(rows):
            energy = json.loads((self.member(index) / "summary.json").read_text()
                                )["diagnostics"]["total_energy"]
            self.assertEqual([row["member"], row["fixed"]], [str(index), ("0.1", "0.2")[index]])
            for statistic in ("final", "mean", "min", "max"):
                self.assertEqual(float(row[f"total_energy_{statistic}"]), energy[statistic])
        self.assertIn("fixed: 0.1 s", (self.member(0) / "scene.yaml").read_text())

    def test_batch_script_runs_a_member(self):
        """What Slurm would run, with the variables it would set."""
        sweep = self.sweep("0.1, 0.2")
        words = self.run_sweep(sweep, DONE, "--slurm", "--no-submit")
        script = self.folder / "out" / "sweep.sbatch"
        self.assertIn(f"sbatch {script}", words)
        subprocess.run(["bash", "-n", str(script)], check=True)
        self.assertIn("#SBATCH --array=0-1%2\n", script.read_text())
        subprocess.run(["bash", str(script)], check=True, timeout=LIMIT, cwd="/",
                       env=environment(SLURM_ARRAY_TASK_ID=1, SLURM_CPUS_PER_TASK=1))
        self.assertEqual([self.record(index)["status"] for index in range(2)], ["waiting", "done"])
        self.assertIn("1 of 2 members done, 1 waiting", self.run_sweep(sweep, DONE, "--collect"))
        with xarray.open_dataset(self.folder / "out" / "ensemble.nc") as ensemble:
            self.assertEqual(list(ensemble["status"].values), ["waiting", "done"])
            self.assertTrue(numpy.isnan(ensemble["kinetic_energy"][0]).all())

    def test_a_member_told_that_its_time_is_up_goes_on_later(self):
        """What a batch system does with a task: SIGUSR1 before its end, and the task once more."""
        sweep = self.sweep("0.1, 4e-3")
        process = self.start(sweep, "--member", "1")
        self.wait_until(lambda: self.checkpoints(1) or process.poll() is not None)
        process.send_signal(signal.SIGUSR1)
        words, _ = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, STOPPED, words)
        self.assertEqual(self.record(1)["status"], "stopped")
        self.run_sweep(sweep, DONE, "--member", "1")
        self.assertEqual([self.record(index)["status"] for index in range(2)], ["waiting", "done"])
        self.assertFalse(self.checkpoints(1))

    def test_a_member_that_is_running_is_not_started_again(self):
        sweep = self.sweep("0.1, 4e-3")
        process = self.start(sweep, "--member", "1")
        self.wait_until(lambda: self.checkpoints(1) or process.poll() is not None)
        (self.member(1) / "log.txt").write_text("what it has written")
        before = os.stat(self.member(1) / "member.json")
        words = self.run_sweep(sweep, FILE, "--member", "1")
        self.assertIn("the folder is in use by process", words)
        self.assertEqual((self.member(1) / "log.txt").read_text(), "what it has written")
        self.assertEqual(os.stat(self.member(1) / "member.json").st_ino, before.st_ino)
        self.assertEqual(self.record(1)["status"], "running")
        words, _ = process.communicate(timeout=LIMIT)
        self.assertEqual(process.returncode, DONE, words)
        self.assertEqual(self.record(1)["status"], "done")

    def test_two_sweeps_do_not_share_a_folder(self):
        sweep = self.sweep("0.1")
        self.run_sweep(sweep, DONE)
        before = contents(self.folder / "out")
        (self.folder / "other").mkdir()
        other = shutil.copy(sweep, self.folder / "other")
        words = self.run_sweep(other, FILE)
        self.assertIn(f"holds the sweep 'sweep' of {sweep}, not 'sweep' of {other}", words)
        self.assertEqual(contents(self.folder / "out"), before)
        self.run_sweep(other, DONE, "--force")

    def test_mistakes_leave_nothing_behind(self):
        words = self.run_sweep(self.sweep("0.1, -1, fast"), USAGE)
        self.assertIn("sweep.yaml:10:48", words)
        self.assertIn("(member 0001)", words)
        self.assertIn("(member 0002)", words)
        self.assertFalse((self.folder / "out").exists())

    def test_what_a_plan_refuses_is_refused_before_the_first_member(self):
        scene = self.write("wave.yaml", f"extends: {WAVE}\ndiagnostics: {{slabs: {{values: [\n"
                           "  {name: mine, variable: boyancy_flux, measure: max}]}}\n")
        text = SWEEP.format(scene=scene, steps="0.1, 0.2", jitters="0.2", profiles="0")
        words = self.run_sweep(self.write("sweep.yaml", text), USAGE)
        self.assertIn("wave.yaml:3:3: error: the slab value 'mine'", words)
        self.assertEqual(words.count("error:"), 1, words)
        self.assertFalse((self.folder / "out").exists())

"""A run whose operator has memory of its own goes on after a restart as if there had been none."""
import os

from program import USAGE, ProgramTest

# From tests/abi/v1_0/pulse.c: in step n the humidity of every parcel grows by n dt.
PULSED = """\
scene: {name: pulsed, title: Parcels moistened by the number of the step}
domain: {extent: [1 m, 1 m], cells: [8, 8]}
time: {end: 1 s, step: {largest: 0.125 s}}
initial: {buoyancy: '0.01*sin(2*pi*x)'}
operators:
  - {use: org.example.v1_0.pulse, name: pulse}
output: {series: {every: 10 s}, checkpoint: {steps: 1}}
"""
PLUGINS = {"PILEUS_PLUGIN_PATH": os.environ["PILEUS_COMPAT_FOLDER"]}
RESUME = ("--threads", "1", "--resume")


class PrivateState(ProgramTest):

    def run_pulse(self, out, values=None, **how):
        return self.run_scene(self.write("pulsed.yaml", PULSED), out, values, env=PLUGINS, **how)

    def test_restart_is_bitwise(self):
        whole = self.run_pulse("whole")
        self.assertEqual(whole.code, 0, whole.text)
        first = self.run_pulse("parted", {"time.max_steps": 3})
        self.assertEqual(first.summary["steps"], 3, first.text)
        rest = self.run_pulse("parted", options=RESUME)
        self.assertEqual(rest.code, 0, rest.text)
        self.assertEqual(rest.summary["steps"], whole.summary["steps"])
        self.assertEqual(rest.summary["state_sha256"], whole.summary["state_sha256"])

    def test_missing_state_is_named(self):
        """The operator has another name than when the checkpoint was written."""
        self.run_pulse("parted", {"time.max_steps": 3})
        scene = self.write("renamed.yaml", PULSED.replace("name: pulse}", "name: beat}"))
        ended = self.run_scene(scene, "parted", env=PLUGINS, options=RESUME)
        self.assert_refused(ended, USAGE, "cannot continue from the checkpoint", "checkpoint_",
                            "no private state of operator 'beat'", "org.example.v1_0.pulse")

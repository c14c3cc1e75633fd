"""Runs in a flow that is given: it undoes what it did, on any threads and across a restart."""
import numpy
from netCDF4 import Dataset

from program import SCENES, WARM_BUBBLE_2D, ProgramTest
from records import differences

STIRRED = SCENES / "stirred_and_unstirred.yaml"
SPACE = {"domain.extent": "[2 km, 2 km, 1 km]", "domain.cells": "[8, 8, 4]",
         "flow.prescribed.y": "'U*sin(pi*z/H)*cos(pi*t/T)'", "parcels.per_cell": 8}


class PrescribedFlow(ProgramTest):

    def test_what_is_done_is_undone(self):
        """Each parcel is where it was, within the error of the scheme: with courant 0.5 on ten cells
        a step turns the velocity by up to 0.5 pi/10, so that the path of 2 km is off by some
        (0.5 pi/10)^4/120 of it, 1 cm, which the shear there and back makes larger."""
        ended = self.run_well(STIRRED)
        self.assertEqual([e for e in ended.summary["expect"] if not e["passed"]], [])
        with Dataset(ended.out / "parcels.nc") as file:
            group = next(iter(file.groups.values()), file)
            sizes = group["row_size"][...]
            self.assertEqual(len(set(sizes.tolist())), 1)
            count = int(sizes[0])
            uid = numpy.asarray(group["uid"][...])
            places = {name: numpy.asarray(group[name][...], dtype=float) for name in ("x_position", "z_position")}
        first, last = slice(0, count), slice(len(uid) - count, len(uid))
        order = numpy.argsort(uid[first]), numpy.argsort(uid[last])
        for name, period in (("x_position", 2000.0), ("z_position", None)):
            moved = places[name][last][order[1]] - places[name][first][order[0]]
            if period:
                moved -= period * numpy.round(moved / period)
            self.assertLess(numpy.abs(moved).max(), 0.1)
            middle = places[name][count:2 * count][numpy.argsort(uid[count:2 * count])]
            self.assertGreater(numpy.abs(middle - places[name][first][order[0]]).max(), 300)

    def test_on_any_threads(self):
        for name, values in (("plane", {}), ("space", SPACE)):
            with self.subTest(name):
                runs = [self.run_well(STIRRED, f"{name}_{n}", values | {"time.max_steps": 12},
                                      ("--threads", str(n))) for n in (1, 2, 3)]
                for run in runs[1:]:
                    self.assertEqual(run.summary["state_sha256"], runs[0].summary["state_sha256"])
                    self.assertEqual(differences(runs[0].out, run.out), [])

    def test_resumed_run_is_the_whole_one(self):
        """With upkeep switched on: parcels split, merge and are corrected as in any flow."""
        values = {"parcels.merging": "true", "parcels.splitting": "true",
                  "parcels.correction_iterations": 2, "output.checkpoint.steps": 7,
                  "time.max_steps": 40}
        whole = self.run_well(STIRRED, "whole", values)
        self.assertNotEqual(whole.summary["parcels"]["initial"], whole.summary["parcels"]["final"])
        self.run_well(STIRRED, "parts", values | {"time.max_steps": 15})
        parts = self.run_well(STIRRED, "parts", values, ("--threads", "2", "--resume"))
        self.assertEqual(parts.summary["state_sha256"], whole.summary["state_sha256"])
        self.assertEqual(parts.summary["diagnostics"], whole.summary["diagnostics"])

    def test_mesh_fields_are_those_of_the_formulas(self):
        ended = self.run_well(STIRRED, values={"time.max_steps": 1})
        with Dataset(ended.out / "fields.nc") as file:
            x, z = numpy.asarray(file["x"][...]), numpy.asarray(file["z"][...])
            w = numpy.asarray(file["z_velocity"][0])
            zeta = numpy.asarray(file["vorticity"][0])
        cosine = numpy.cos(2 * numpy.pi * x / 2000)[None, :]
        sine = numpy.sin(numpy.pi * z / 1000)[:, None]
        # Single precision: 2^-24 of the largest value.
        self.assertLess(numpy.abs(w - 3 * cosine * sine).max(), 3e-7)
        due = -2 * 3 * numpy.pi / 1000 * numpy.sin(2 * numpy.pi * x / 2000)[None, :] * sine
        self.assertLess(numpy.abs(zeta - due).max(), 3e-9)

    def test_no_time_goes_into_the_inversion(self):
        phases = self.run_well(STIRRED, values={"time.max_steps": 2}).summary["phases"]
        for name in ("compensation", "inversion", "tendency"):
            self.assertEqual(phases[name]["calls"], 0)
        self.assertGreater(phases["interpolate"]["calls"], 0)

    def test_a_warm_bubble_stays_where_it_is(self):
        """Buoyancy does nothing, a flow of nothing neither."""
        ended = self.run_well(WARM_BUBBLE_2D, values={"flow.prescribed.z": 0})
        self.assertEqual(ended.diagnostic("max_speed")["max"], 0)
        self.assertEqual(ended.diagnostic("max_vorticity")["max"], 0)
        self.assertGreater(ended.diagnostic("max_buoyancy")["max"], 0.01)

    def test_one_column(self):
        """A column of one cell in each horizontal direction, in the plane and in space."""
        for values in ({"domain.cells": "[1, 16]"},
                       SPACE | {"domain.cells": "[1, 1, 4]"}):
            up = {"flow.prescribed.x": 0, "flow.prescribed.z": "'0.1*sin(pi*t/T)'",
                  "flow.prescribed.y": 0} if len(values) > 1 else {
                      "flow.prescribed.x": 0, "flow.prescribed.z": "'0.1*sin(pi*t/T)'"}
            ended = self.run_well(STIRRED, values=values | up | {"time.step.largest": "60 s"},
                                  options=("--force",))
            self.assertAlmostEqual(ended.diagnostic("max_vertical_velocity")["max"], 0.1, 3)

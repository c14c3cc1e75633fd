"""What `pileus new-plugin` writes builds, passes its own tests and runs, untouched."""
from project import FILE, PLUGINS, PROGRAM, USAGE, WORK, ProjectTest


class NewPlugin(ProjectTest):

    def check_kind(self, kind):
        project, build = WORK / "warm_air", WORK / "build"
        text = self.call(PROGRAM, "new-plugin", "warm_air", "--kind", kind)
        written = {path.name for path in project.iterdir()}
        self.assertEqual(written, {"CMakeLists.txt", "plugin.cpp", "rates.hpp", "rates_test.cpp",
                                   "example.yaml", "README.md", "LICENSE"})
        for name in written:
            self.assertIn(f"warm_air/{name}", text)
            for left_over in ("my_scheme", "MyScheme", "My scheme", "PILEUS_VERSION"):
                self.assertNotIn(left_over, (project / name).read_text())
        self.build(project, build, "-D", "CMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror")
        self.run_tests_of(build)
        summary = self.simulate(project / "example.yaml", "results", plugins=build / PLUGINS)
        self.assertEqual(summary["status"], "done")
        described = self.call(PROGRAM, "inspect", build / PLUGINS / "libwarm_air.so")
        self.assertIn("org.example.warm_air", described)
        # Installed beside others it is found without a path.
        self.call("cmake", "--install", build, "--prefix", WORK / "prefix")
        self.assertEqual(len(list((WORK / "prefix").glob("lib*/**/plugins/libwarm_air.so"))), 1)

    def test_microphysics(self):
        self.check_kind("microphysics")

    def test_mixing(self):
        self.check_kind("mixing")

    def test_surface(self):
        self.check_kind("surface")

    def test_forcing(self):
        self.check_kind("forcing")


class Refusals(ProjectTest):

    def refused(self, *arguments):
        return self.call(PROGRAM, "new-plugin", *arguments, code=USAGE)

    def test_names(self):
        for name in ("WarmRain", "1rain", "rain-fall", "_rain", "rain_", "two__rains", "a/b", "",
                     "regen_\u00fc"):
            with self.subTest(name):
                self.assertIn("lower-case letters", self.refused("--kind", "mixing", "--", name))
        self.assertIn("40 fit", self.refused("r" * 41, "--kind", "mixing"))
        self.assertIn("target of CMake", self.refused("test", "--kind", "mixing"))
        self.assertEqual(list(WORK.iterdir()), [])

    def test_kinds(self):
        self.assertIn("did you mean 'surface'", self.refused("rain", "--kind", "surfaces"))
        self.assertIn("--kind", self.refused("rain"))
        self.assertEqual(list(WORK.iterdir()), [])

    def test_what_exists(self):
        for make in (lambda p: p.mkdir(), lambda p: p.write_text("mine"),
                     lambda p: p.symlink_to("nowhere")):
            path = WORK / "taken"
            make(path)
            text = self.refused("rain", "--kind", "mixing", "--out", path)
            self.assertIn("exists already", text)
            if path.is_symlink() or path.is_file():
                path.unlink()
            else:
                path.rmdir()

    def test_place_that_cannot_be_made(self):
        (WORK / "file").write_text("")
        self.call(PROGRAM, "new-plugin", "rain", "--kind", "mixing", "--out", WORK / "file" / "x",
                  code=FILE)
        (WORK / "file").unlink()

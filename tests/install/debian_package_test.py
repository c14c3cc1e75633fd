"""The Debian package holds all of it, names what it needs, and works where it is unpacked."""
import shutil
import unittest

from project import BUILD, SOURCE, WORK, ProjectTest

MISSING = [tool for tool in ("cpack", "dpkg", "dpkg-shlibdeps") if shutil.which(tool) is None]


@unittest.skipIf(MISSING, f"not installed: {', '.join(MISSING)}")
class DebianPackage(ProjectTest):

    def test_package(self):
        # Compression takes most of the time and shows nothing here.
        self.call("cpack", "--config", BUILD / "CPackConfig.cmake", "-B", WORK / "made", "-D",
                  "CPACK_DEBIAN_COMPRESSION_TYPE=gzip")
        package = next((WORK / "made").glob("pileus_*.deb"))
        self.check_control(self.call("dpkg", "--info", package))
        self.check_contents(self.call("dpkg", "--contents", package))
        root = WORK / "root"
        self.call("dpkg", "-x", package, root)
        self.check_program(root / "usr")

    def check_control(self, control):
        depends = next(line for line in control.splitlines() if line.startswith(" Depends:"))
        for library in ("libc6", "libfftw3-double3", "libhdf5", "libyaml-cpp", "libspdlog",
                        "libmuparser", "libudunits2", "libssl", "libgomp1"):
            self.assertIn(library, depends)
        self.assertIn("Recommends: gnuplot-nox", control)

    def check_contents(self, contents):
        names = {line.split()[-1] for line in contents.splitlines()}
        plugins = {p.name for p in (SOURCE / "plugins").iterdir() if p.is_dir()}
        expected = {"./usr/bin/pileus", "./usr/include/pileus/abi.h",
                    "./usr/include/pileus/plugin.hpp", "./usr/share/pileus/schemas/effects.yaml",
                    "./usr/share/pileus/scenes/straka/straka.yaml", "./usr/share/doc/pileus/copyright"}
        self.assertLessEqual(expected, names)
        for plugin in plugins:
            self.assertTrue(any(n.endswith(f"/pileus/plugins/lib{plugin}.so") for n in names), plugin)
        for part in ("Config", "ConfigVersion", "Targets", "Plugin"):
            self.assertTrue(any(n.endswith(f"/cmake/Pileus/Pileus{part}.cmake") for n in names), part)
        outside = [n for n in names if not n.startswith("./usr/") and n not in ("./",)]
        self.assertEqual(outside, [])

    def check_program(self, prefix):
        """Its own plugins and schema, with nothing of the build in sight."""
        program = prefix / "bin" / "pileus"
        listed = self.call(program, "plugins")
        self.assertNotIn(str(BUILD / "lib"), listed)
        self.assertEqual(self.call(program, "schema"),
                         (prefix / "share/pileus/schemas/scene.schema.json").read_text())
        self.call(program, "check", "--quiet", "--threads", 1, "--out", WORK / "checked",
                  prefix / "share/pileus/scenes/moist_thermal_2d/moist_thermal_2d_small.yaml")

"""Projects of strangers: built against the staged package alone, and run with its program."""
import json
import os
import shutil
import subprocess
import unittest
from pathlib import Path

STAGE = Path(os.environ["PILEUS_STAGE"])  # where the package is installed
SOURCE = Path(os.environ["PILEUS_SOURCE"])
BUILD = Path(os.environ["PILEUS_BUILD"])  # of Pileus itself
WORK = Path(os.environ["PILEUS_WORK"])  # this test's own folder
HERE = Path(__file__).parent

PROGRAM = STAGE / "bin" / "pileus"
PLUGINS = Path("lib") / "pileus" / "plugins"  # in a build folder
DONE, USAGE, FILE = 0, 2, 5  # exit codes of the program
LIMIT = 300  # s


def environment(**extra):
    """Nothing of the caller's Pileus; idle threads sleep; compilers through ccache where there is
    one."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith("PILEUS_")}
    if ccache := os.environ.get("PILEUS_CCACHE"):
        if not ccache.endswith("NOTFOUND"):
            kept |= {"CMAKE_C_COMPILER_LAUNCHER": ccache, "CMAKE_CXX_COMPILER_LAUNCHER": ccache}
    return kept | {"OMP_WAIT_POLICY": "passive"} | {k: str(v) for k, v in extra.items()}


def installed_plugins():
    """The folder of the in-tree plugins in the staged package."""
    return next(STAGE.glob("lib*/**/pileus/plugins"))


class ProjectTest(unittest.TestCase):
    """Builds a project and runs scenes with its library."""

    maxDiff = 2000

    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        WORK.mkdir(parents=True)

    def call(self, *command, code=DONE, cwd=WORK, **extra):
        """Runs a command to its end, which must have this exit code; returns what it printed."""
        ended = subprocess.run([str(word) for word in command], cwd=cwd, env=environment(**extra),
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               timeout=LIMIT, check=False)
        self.assertEqual(ended.returncode, code, f"{command}\n{ended.stdout}")
        return ended.stdout

    def build(self, project, build, *options):
        """Configures and builds against the package; nothing of this source tree is seen."""
        self.call("cmake", "-G", os.environ["PILEUS_GENERATOR"], "-S", project, "-B", build,
                  "-D", f"CMAKE_PREFIX_PATH={STAGE}", "-D", "CMAKE_EXPORT_COMPILE_COMMANDS=ON",
                  *options)
        self.call("cmake", "--build", build)
        for command in json.loads((build / "compile_commands.json").read_text()):
            self.assertNotIn(str(SOURCE / "core"), command["command"])

    def run_tests_of(self, build):
        """The project's own tests; those of the contract where the program has the verb."""
        knows_conform = subprocess.run([PROGRAM, "conform", "--help"], capture_output=True,
                                       check=False).returncode == DONE
        without = () if knows_conform else ("-E", "conformance")
        text = self.call("ctest", "--test-dir", build, "--output-on-failure", *without)
        self.assertIn("100% tests passed", text)

    def simulate(self, scene, out, *options, plugins):
        """Runs a scene to its end and returns its summary."""
        self.call(PROGRAM, "run", scene, "--quiet", "--out", WORK / out, *options,
                  PILEUS_PLUGIN_PATH=plugins)
        return json.loads((WORK / out / "summary.json").read_text())

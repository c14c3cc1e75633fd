"""A plugin in C11, built without a C++ compiler, is one like any other."""
from project import HERE, PLUGINS, PROGRAM, WORK, ProjectTest

PROJECT = HERE / "newtonian_cooling"


class PluginInC(ProjectTest):

    def test_builds_and_runs(self):
        build = WORK / "build"
        flags = "-Wall -Wextra -Wpedantic -Werror"
        self.build(PROJECT, build, "-D", f"CMAKE_C_FLAGS={flags}", "-D", "CMAKE_CXX_COMPILER=none")
        self.run_tests_of(build)
        described = self.call(PROGRAM, "inspect", build / PLUGINS / "libnewtonian_cooling.so")
        self.assertIn("org.example.newtonian_cooling", described)
        once, again = (self.simulate(PROJECT / "cooling.yaml", f"threads_{n}", "--threads", n,
                                     plugins=build / PLUGINS) for n in (1, 3))
        self.assertEqual(once["state_sha256"], again["state_sha256"])

"""The plugin of the tutorial: its files, as the page has them, build, pass and run."""
import re

from project import PLUGINS, PROGRAM, SOURCE, STAGE, WORK, ProjectTest

PAGE = SOURCE / "docs" / "plugins" / "tutorial.md"
FILE = re.compile(r"<!-- file: (\S+) -->\n+```\w+\n(.*?)```\n", re.DOTALL)


class Tutorial(ProjectTest):

    def test_files_of_the_page(self):
        project, build = WORK / "radon", WORK / "radon" / "build"
        self.call(PROGRAM, "new-plugin", "radon", "--kind", "surface")
        files = dict(FILE.findall(PAGE.read_text()))
        self.assertEqual(set(files), {"radon/rates.hpp", "radon/rates_test.cpp", "radon/plugin.cpp",
                                      "radon/example.yaml", "radon/thermal.yaml"})
        for name, text in files.items():
            (WORK / name).write_text(text.replace("/usr/share", f"{STAGE}/share"))
        self.build(project, build)
        self.run_tests_of(build)
        summary = self.simulate(project / "thermal.yaml", "thermal", "--threads", "1",
                                plugins=build / PLUGINS)
        self.assertGreater(summary["diagnostics"]["mean_passive_tracer"]["max"], 0)

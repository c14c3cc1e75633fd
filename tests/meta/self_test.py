"""Every check finds the mistake it is there for: each runs on a small tree that has it."""
import hashlib
import json
import tempfile
import unittest
from pathlib import Path

import frozen
import include_graph
import repository


class Checks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

    def write(self, name, text=""):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def found(self, check, *fragments):
        violations = check(self.root)
        self.assertEqual(len(violations), len(fragments), violations)
        for violation, fragment in zip(violations, fragments):
            self.assertIn(fragment, violation)

    def test_include_that_points_up(self):
        self.write("core/src/mesh/a.cpp", '#include "base/error.hpp"\n#include "parcels/store.hpp"\n')
        self.found(include_graph.violations, "a.cpp:2: mesh may not include parcels")

    def test_sibling_folders_do_not_see_each_other(self):
        self.write("core/src/host/a.cpp", '#include "scene/scene.hpp"\n')
        self.found(include_graph.violations, "host may not include scene")

    def test_third_party_header_outside_its_home(self):
        self.write("core/src/parcels/a.hpp", "#include <vector>\n#include <fftw3.h>\n")
        self.write("core/src/mesh/b.hpp", "#include <fftw3.h>\n#include <strange/new.hpp>\n")
        self.found(include_graph.violations, "strange/new.hpp> has no home", "<fftw3.h> has its home")

    def test_plugin_that_sees_the_core(self):
        self.write("plugins/p/rates.hpp")
        self.write("plugins/p/plugin.cpp",
                   '#include <pileus/plugin.hpp>\n#include "rates.hpp"\n#include "mesh/grid.hpp"\n')
        self.found(include_graph.violations, 'plugin.cpp:3: a plugin may not include "mesh/grid.hpp"')

    def test_installed_header_with_a_dependency(self):
        self.write("core/include/pileus/abi.h", "#include <stdint.h>\n#include <Eigen/Core>\n")
        self.found(include_graph.violations, "an installed header may not include <Eigen/Core>")

    def test_long_file(self):
        self.write("core/src/base/long.cpp", "int x;\n" * 501)
        self.write("core/src/base/short.cpp", "int x;\n" * 500)
        self.found(repository.file_sizes, "long.cpp: 501 lines")

    def test_forbidden_words(self):
        self.write("docs/a.md", "fine\n" + "TO" + "DO: later\n" + "see /ho" + "me/someone/file\n")
        self.write("docs/b.md", "a ratio w/ho" + "me/x and https://host/wo" + "rk/y are fine\n")
        self.found(repository.forbidden_words, "a.md:2", "a.md:3")

    def test_plugin_name_in_the_core(self):
        self.write("plugins/rain_maker/plugin.cpp")
        self.write("core/src/model/a.cpp", 'if (id == "rain_maker") {}\n')
        self.found(repository.plugin_names_in_core, "a.cpp:1")

    def test_broken_links(self):
        self.write("docs/a.md", "# One thing\n[ok](b.md) [web](https://x.org) [self](#one-thing)\n"
                   "[gone](c.md)\n[no heading](b.md#two)\n```\n[code](d.md)\n```\n")
        self.write("docs/b.md", "# One\n")
        self.found(repository.broken_links, "'c.md' leads nowhere", "no heading '#two'")

    def test_incomplete_scene(self):
        self.write("configs/scenes/wave/wave.yaml", "name: wave\n")
        self.found(repository.scenes, "has no README.md", "names no schema")

    def freeze(self):
        """A tree whose contract is released: header, layout, and their digests."""
        header = "#define PILEUS_ABI_MAJOR 1u\n#define PILEUS_ABI_MINOR 0u\n"
        layout = "# minor 0\nsize 4\n"
        self.write("core/include/pileus/abi.h", header)
        self.write("tests/abi/v1_0/abi.h", header)
        self.write("tests/abi/layout_v1.txt", layout + "# minor 1\nmore 8\n")
        digests = {"abi.h": header, "layout_v1.txt:minor 0": layout}
        self.write("tests/abi/v1_0/SHA256SUMS", "".join(
            f"{hashlib.sha256(text.encode()).hexdigest()}  {name}\n"
            for name, text in digests.items()))
        return header

    def test_released_contract(self):
        header = self.freeze()
        self.found(frozen.frozen_contract)
        self.write("core/include/pileus/abi.h", header + "/* more */\n")
        self.found(frozen.frozen_contract, "is no longer")
        self.write("tests/abi/v1_0/abi.h", header + "/* more */\n")
        self.found(frozen.frozen_contract, "v1_0/abi.h: was released and has changed")
        self.write("tests/abi/v1_0/abi.h", header)
        self.write("core/include/pileus/abi.h", header.replace("MINOR 0u", "MINOR 1u"))
        self.found(frozen.frozen_contract)
        self.write("tests/abi/layout_v1.txt", "# minor 0\nsize 8\n# minor 1\nmore 8\n")
        self.found(frozen.frozen_contract, "layout_v1.txt:minor 0: was released")

    def test_unregistered_test(self):
        self.write("tests/unit/a.cpp")
        self.write("tests/unit/b.cpp")
        self.write("tests/install/project/c.cpp")
        self.write("tests/install/project/CMakeLists.txt", "project(c)\n")
        self.write("build/compile_commands.json",
                   json.dumps([{"directory": str(self.root), "file": "tests/unit/a.cpp"}]))
        found = repository.unregistered_tests(self.root, self.root / "build")
        self.assertEqual(len(found), 1)
        self.assertIn("b.cpp", found[0])


if __name__ == "__main__":
    unittest.main()

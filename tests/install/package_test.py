"""What is installed: the headers alone, each by itself, and a package that can be moved."""
import re
import shutil

from project import BUILD, HERE, PROGRAM, SOURCE, STAGE, WORK, ProjectTest

PROJECT = """\
cmake_minimum_required(VERSION 3.25)
project(stranger LANGUAGES CXX)
find_package(Pileus {} CONFIG REQUIRED COMPONENTS {})
"""


class Package(ProjectTest):

    def configure(self, version, component, prefix, **how):
        project = WORK / f"project_{version}_{component}"
        project.mkdir(exist_ok=True)
        (project / "CMakeLists.txt").write_text(PROJECT.format(version, component))
        return self.call("cmake", "-S", project, "-B", project / "build", "-D",
                         f"CMAKE_PREFIX_PATH={prefix}", **how)

    def test_headers_stand_alone(self):
        """Each compiles as the only include of a file, with nothing but the installed folder."""
        include = STAGE / "include"
        headers = sorted((include / "pileus").iterdir())
        self.assertEqual({p.name for p in headers},
                         {p.name for p in (SOURCE / "core" / "include" / "pileus").iterdir()})
        sources = WORK / "headers"
        sources.mkdir()
        for header in headers:
            languages = [("c++", "c++20")] + ([("c", "c11")] if header.suffix == ".h" else [])
            for language, standard in languages:
                source = sources / f"{header.stem}.{'c' if language == 'c' else 'cpp'}"
                source.write_text(f"#include <pileus/{header.name}>\n"
                                  f"#include <pileus/{header.name}>\n")
                with self.subTest(header.name, language=language):
                    self.call("c++" if language == "c++" else "cc", f"-std={standard}",
                              "-pedantic-errors", "-Wall", "-Wextra", "-Werror", "-fsyntax-only",
                              "-I", include, source)

    def test_component_of_headers_alone(self):
        """A machine without the program can build plugins."""
        prefix = WORK / "headers_only"
        self.call("cmake", "--install", BUILD, "--component", "plugin", "--prefix", prefix)
        files = {str(p.relative_to(prefix)) for p in prefix.rglob("*") if p.is_file()}
        self.assertTrue(all("/cmake/Pileus/" in f or f.startswith("include/pileus/")
                            for f in files), files)
        build = WORK / "build_headers_only"
        text = self.call("cmake", "-S", HERE / "newtonian_cooling", "-B", build, "-D",
                         f"CMAKE_PREFIX_PATH={prefix}")
        self.assertIn("no test newtonian_cooling.conformance", text)
        self.call("cmake", "--build", build)

    def version(self):
        text = (SOURCE / "CMakeLists.txt").read_text()
        found = re.search(r"^  VERSION (\d+)\.(\d+)", text, re.MULTILINE)
        return int(found[1]), int(found[2])

    def test_versions_and_components(self):
        major, minor = self.version()
        self.configure(f"{major}.{minor}", "plugin", STAGE)
        text = self.configure(f"{major}.{minor + 1}", "plugin", STAGE, code=1)
        self.assertIn("version", text)
        self.assertIn("core", self.configure(f"{major}.{minor}", "core", STAGE, code=1))

    def test_moved(self):
        """The program finds its plugins, scenes and schemas wherever the prefix lies."""
        moved = WORK / "else" / "where"
        shutil.copytree(STAGE, moved)
        text = self.call(moved / "bin" / "pileus", "plugins")
        self.assertIn(f"{moved}/", text)
        self.assertNotIn(f"{STAGE}/", text)
        self.call(moved / "bin" / "pileus", "check", "--quiet", "--threads", 1, "--out",
                  WORK / "checked",
                  moved / "share/pileus/scenes/resting_atmosphere/resting_atmosphere_small.yaml")
        self.configure("{}.{}".format(*self.version()), "plugin", moved)

    def test_scenes_name_the_installed_schema(self):
        scenes = sorted((STAGE / "share" / "pileus" / "scenes").glob("*/*.yaml"))
        in_tree = sorted((SOURCE / "configs" / "scenes").glob("*/*.yaml"))
        self.assertEqual([p.name for p in scenes], [p.name for p in in_tree])
        for scene in scenes:
            first = scene.read_text().splitlines()[0]
            schema = re.match(r"# yaml-language-server: \$schema=(\S+)", first)[1]
            self.assertTrue((scene.parent / schema).is_file(), scene)

    def test_installed_schema_is_what_the_program_prints(self):
        printed = self.call(PROGRAM, "schema")
        kept = (STAGE / "share" / "pileus" / "schemas" / "scene.schema.json").read_text()
        self.assertEqual(printed, kept)

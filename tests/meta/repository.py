"""Rules about the text of the repository: sizes, words, plugin names in the core, links, scenes."""
import json
import re
from pathlib import Path

import tree

LONGEST_FILE = 500  # lines
CODE_SUFFIXES = tree.SOURCE_SUFFIXES | {".py", ".cmake", ".sh"}
# Notes to oneself, and paths that exist on one machine only.
FORBIDDEN = re.compile(r"\b(TO" r"DO|FIX" r"ME|XX" r"X)\b|(?<![\w.}])/(work|root|home|tmp)/\w")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
FENCE = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
SCHEMA_LINE = re.compile(r"^# yaml-language-server: \$schema=(\S+)")


def file_sizes(root):
    """A file holds one idea; beyond 500 lines it holds several."""
    return [
        f"{path}: {count} lines, more than {LONGEST_FILE}"
        for path in tree.files(root, "core", "plugins", "tests", suffixes=CODE_SUFFIXES)
        if (count := len(tree.text_lines(path))) > LONGEST_FILE
    ]


def forbidden_words(root):
    return [
        f"{path}:{number}: '{match[0]}'"
        for path in tree.files(root)
        for number, line in enumerate(tree.text_lines(path), 1)
        if (match := FORBIDDEN.search(line))
    ]


def plugin_names_in_core(root):
    """The core knows no plugin by name: it finds libraries and reads what they declare."""
    names = [p.name for p in (Path(root) / "plugins").iterdir() if p.is_dir()]
    if not names:
        return []
    pattern = re.compile(r"\b(" + "|".join(map(re.escape, names)) + r")\b")
    return [
        f"{path}:{number}: names the plugin '{match[0]}'"
        for path in tree.files(root, "core", suffixes=CODE_SUFFIXES)
        for number, line in enumerate(tree.text_lines(path), 1)
        if (match := pattern.search(line))
    ]


def anchors(path):
    """The anchors that a Markdown page's headings make."""
    found = set()
    for line in tree.text_lines(path):
        if line.startswith("#"):
            heading = line.lstrip("#").strip().lower()
            heading = re.sub(r"[^\w\- ]", "", heading)
            found.add(heading.replace(" ", "-"))
    return found


def broken_links(root):
    """Relative links of Markdown pages lead to files, and their anchors to headings."""
    found = []
    for page in tree.files(root, suffixes={".md"}):
        text = FENCE.sub("", page.read_text(encoding="utf-8"))
        for target in LINK.findall(text):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            path = page.parent / name if name else page
            if not path.exists():
                found.append(f"{page}: link to '{target}' leads nowhere")
            elif anchor and path.suffix == ".md" and anchor not in anchors(path):
                found.append(f"{page}: no heading '#{anchor}' in {path.name}")
    return found


def scenes(root):
    """A scene folder holds <folder>.yaml, a README and a variant that is quick to check; every
    YAML file names the schema that editors complete it with."""
    configs = Path(root) / "configs"
    found = []
    for folder in sorted(p for p in (configs / "scenes").iterdir() if p.is_dir()):
        for name in (f"{folder.name}.yaml", "README.md"):
            if not (folder / name).is_file():
                found.append(f"{folder}: has no {name}")
    hard = configs / "hard"
    if hard.is_dir():
        listed = (hard / "README.md").read_text(encoding="utf-8")
        for path in sorted(hard.glob("*.yaml")):
            if f"`{path.stem}`" not in listed:
                found.append(f"{path}: README.md does not say what it is for")
    for path in tree.files(configs, suffixes={".yaml", ".yml"}):
        first = (tree.text_lines(path) or [""])[0]
        match = SCHEMA_LINE.match(first)
        if not match:
            found.append(f"{path}:1: the first line names no schema for editors")
        elif not (path.parent / match[1]).is_file():
            found.append(f"{path}:1: the schema '{match[1]}' does not exist")
    return found


def is_of_own_project(path, root):
    """Whether a CMake project of its own holds the file, which the build does not enter."""
    for folder in path.parents:
        if folder == Path(root):
            return False
        lists = folder / "CMakeLists.txt"
        if lists.is_file() and re.search(r"^project\(", lists.read_text(), re.MULTILINE):
            return True
    return False


def unregistered_tests(root, build):
    """Every C++ file under tests/ and plugins/*/tests is compiled by some target; projects of their
    own are built by tests/install."""
    commands = json.loads((Path(build) / "compile_commands.json").read_text())
    compiled = {Path(c["directory"], c["file"]).resolve() for c in commands}
    sources = tree.files(root, "tests", suffixes={".cpp", ".c"})
    sources += [p for p in tree.files(root, "plugins", suffixes={".cpp", ".c"})
                if "tests" in p.relative_to(root).parts]
    return [f"{p}: no target compiles it" for p in sources if p.resolve() not in compiled and not is_of_own_project(p, root)]

"""Includes point one way, and each third-party header has one home."""
import re

import tree

# Folder of core/src → the folders it may include. Derived from the arrows
# {study, authoring → model, conform} → {planner, coupling, output} → {dynamics, host, scene} →
# parcels → mesh → base.
LAYERS = [["base"], ["mesh"], ["parcels"], ["dynamics", "host", "scene"],
          ["planner", "coupling", "output"], ["model"], ["study", "authoring"]]
ALLOWED = {
    folder: {folder} | {f for lower in LAYERS[:level] for f in lower}
    for level, layer in enumerate(LAYERS) for folder in layer
}
ALLOWED["conform"] = ALLOWED["coupling"] | {"conform"}
ALLOWED["cli"] = {f for layer in LAYERS for f in layer} | {"cli", "conform"}

# First part of a third-party include → the folders that may name it.
HOMES = {
    "spdlog": {"base"},
    "udunits2.h": {"base"},
    "openssl": {"base"},
    "Random123": {"base"},
    "omp.h": {"base", "mesh", "model"},
    "yaml-cpp": {"scene"},
    "muParser.h": {"scene"},
    "fftw3.h": {"mesh"},
    "hdf5.h": {"output", "scene"},
    "hdf5_hl.h": {"output", "scene"},
    "dlfcn.h": {"host"},
    "CLI": {"cli"},
    "Eigen": {"mesh", "parcels", "dynamics"},
    "boost": {"dynamics", "parcels", "planner", "scene", "study"},
    "nlohmann": {"scene", "host", "planner", "coupling", "output", "model", "study", "cli",
                 "conform"},
    "fmt": {"base", "scene", "host", "planner", "coupling", "output", "model", "study",
            "authoring", "conform", "cli"},
}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]')


def includes(path):
    """(line number, bracket, path) of every include of a file."""
    for number, line in enumerate(tree.text_lines(path), 1):
        if match := INCLUDE.match(line):
            yield number, match[1], match[2]


def is_standard(name):
    """C++ and POSIX headers: no slash or a system folder, and not claimed by a home."""
    return ("/" not in name or name.startswith("sys/")) and name not in HOMES


def core_violation(folder, bracket, name):
    """Why core/src/<folder> (or cli) may not include `name`; None when it may."""
    first = name.split("/")[0]
    if first == "pileus":  # the installed surface, open to all
        return None
    if bracket == '"':
        if first not in ALLOWED:
            return f'"{name}" is not a path from core/src'
        if first not in ALLOWED[folder]:
            return f"{folder} may not include {first}"
    elif first in HOMES:
        if folder not in HOMES[first]:
            return f"<{name}> has its home in {', '.join(sorted(HOMES[first]))}, not in {folder}"
    elif not is_standard(name):
        return f"<{name}> has no home; give it one in tests/meta/include_graph.py"
    return None


def public_violation(path, bracket, name, what):
    """The installed headers and the plugins see the standard library, <pileus/…> and themselves."""
    if bracket == '"':
        return None if (path.parent / name).is_file() else f'{what} may not include "{name}"'
    if name.startswith("pileus/") or (is_standard(name) and name != "omp.h"):
        return None
    return f"{what} may not include <{name}>"


def violations(root):
    found = []

    def check(path, judge):
        for number, bracket, name in includes(path):
            if why := judge(bracket, name):
                found.append(f"{path}:{number}: {why}")

    for path in tree.files(root, "core/src", "core/cli", suffixes=tree.SOURCE_SUFFIXES):
        parts = path.relative_to(root).parts
        if parts[1] == "cli":  # its files see each other by their bare names
            check(path, lambda b, n: None if b == '"' and (path.parent / n).is_file()
                  else core_violation("cli", b, n))
            continue
        folder = parts[2]
        if folder not in ALLOWED:
            found.append(f"{path}: folder '{folder}' is not in the include table")
            continue
        check(path, lambda bracket, name: core_violation(folder, bracket, name))
    for path in tree.files(root, "core/include", suffixes=tree.SOURCE_SUFFIXES):
        check(path, lambda b, n: public_violation(path, b, n, "an installed header"))
    for path in tree.files(root, "plugins", suffixes=tree.SOURCE_SUFFIXES):
        if "tests" not in path.relative_to(root).parts:
            check(path, lambda b, n: public_violation(path, b, n, "a plugin"))
    return found

"""tidy.py CLANG_TIDY ROOT BUILD: clang-tidy on every compiled source of core/ and plugins/.

A source that passed is not looked at again until it, a header it includes, its compile command or
the configuration changes; what it includes is what the build recorded.
"""
import concurrent.futures
import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

OBJECT = re.compile(r" -o (\S+)")


def recorded_dependencies(build):
    """Object file → the project headers and sources it was made from, as ninja recorded them."""
    text = subprocess.run(["ninja", "-C", build, "-t", "deps"], capture_output=True, text=True,
                          check=True).stdout
    dependencies, current = {}, None
    for line in text.splitlines():
        if not line.strip():
            current = None
        elif not line.startswith(" "):
            current = dependencies.setdefault(line.split(": #deps")[0], [])
        elif current is not None:
            current.append(Path(build, line.strip()).resolve())
    return dependencies


def key_of(command, dependencies, root):
    """A digest of all that decides clang-tidy's verdict on one source, wherever the tree lies."""
    digest = hashlib.sha256(command["command"].replace(str(root), "").encode())
    digest.update((root / ".clang-tidy").read_bytes())
    ours = [p for p in dependencies if root in p.parents] or [Path(command["file"])]
    for path in sorted(ours):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def main(clang_tidy, root, build):
    root, build = Path(root).resolve(), Path(build).resolve()
    passed_folder = build / "tidy_passed"
    passed_folder.mkdir(exist_ok=True)
    dependencies = recorded_dependencies(build)
    wanted = [root / "core", root / "plugins"]
    work = []
    for command in json.loads((build / "compile_commands.json").read_text()):
        source = Path(command["file"])
        if any(folder in source.parents for folder in wanted):
            objects = OBJECT.findall(command["command"])
            key = key_of(command, dependencies.get(objects[-1], []), root)
            if not (passed_folder / key).exists():
                work.append((source, passed_folder / key))

    def check(item):
        source, stamp = item
        result = subprocess.run([clang_tidy, "-p", build, "--quiet", "--extra-arg=-w", source],
                                capture_output=True, text=True)
        if result.returncode == 0:
            stamp.touch()
        return source, result

    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for source, result in pool.map(check, work):
            if result.returncode != 0:
                failed += 1
                print(f"{source}\n{result.stdout}{result.stderr}")
    print(f"{len(work)} sources looked at, {failed} with findings")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main(*sys.argv[1:])

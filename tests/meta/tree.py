"""The files of the repository, and how a check reports: shared by the checks of this folder."""
import os
import sys
from pathlib import Path

SOURCE_SUFFIXES = {".cpp", ".hpp", ".h", ".c"}
NOT_OURS = {"build", "results", "__pycache__"}


def files(root, *folders, suffixes=None):
    """Paths under root/folder for each folder (all of root without one), sorted; build outputs,
    results and hidden folders are left out. `suffixes` limits the kinds."""
    root = Path(root)
    found = []
    for start in [root / folder for folder in folders] or [root]:
        for path, folder_names, names in os.walk(start):
            folder_names[:] = [
                n for n in folder_names
                if n not in NOT_OURS and (not n.startswith(".") or n == ".ci")
            ]
            # In a linked worktree .git is a file that names a path of the machine.
            found += [Path(path, n) for n in names if n != ".git"]
    return sorted(p for p in found if suffixes is None or p.suffix in suffixes)


def text_lines(path):
    """The lines of a text file; none for a binary one."""
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        return []


def report(violations):
    """Prints one violation a line and ends the process: 0 without any, else 1."""
    for violation in violations:
        print(violation)
    print(f"{len(violations)} violations")
    sys.exit(1 if violations else 0)

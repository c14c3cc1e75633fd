"""format.py CLANG_FORMAT ROOT: every C and C++ file is as clang-format would write it."""
import subprocess
import sys

import tree

if __name__ == "__main__":
    clang_format, root = sys.argv[1:]
    sources = tree.files(root, "core", "plugins", "tests", suffixes=tree.SOURCE_SUFFIXES)
    sys.exit(subprocess.run([clang_format, "--dry-run", "--Werror", *sources]).returncode)

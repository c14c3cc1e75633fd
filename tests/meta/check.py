"""check.py CHECK ROOT [BUILD]: runs one check of the repository's rules and prints what breaks it."""
import sys
from pathlib import Path

import frozen
import include_graph
import repository
import tree

CHECKS = {
    "include_graph": include_graph.violations,
    "file_sizes": repository.file_sizes,
    "forbidden_words": repository.forbidden_words,
    "plugin_names_in_core": repository.plugin_names_in_core,
    "links": repository.broken_links,
    "scenes": repository.scenes,
    "frozen_contract": frozen.frozen_contract,
    "registered_tests": repository.unregistered_tests,
}

if __name__ == "__main__":
    tree.report(CHECKS[sys.argv[1]](*map(Path, sys.argv[2:])))

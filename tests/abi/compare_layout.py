"""compare_layout.py RECORD PROGRAM: what PROGRAM prints of the contract's layout and values is what
RECORD holds.

The record has a part per minor version, begun by a line "# minor N". A later part adds lines, and
sizes of tables that have grown; no other line is ever changed, since plugins are built with it.
"""
import re
import subprocess
import sys
from pathlib import Path

from header import FROZEN

MINOR = "PILEUS_ABI_MINOR"


def read_record(text):
    """The lines of all parts as a dict, and what is wrong with the parts."""
    known, wrong, minor = {}, [], -1
    for line in text.splitlines():
        part = re.fullmatch(r"# minor (\d+)", line)
        if part:
            if int(part[1]) != minor + 1:
                wrong.append(f"part 'minor {part[1]}' follows minor {minor}")
            minor = int(part[1])
            continue
        name, value = line.split(" ", 1)
        grows = name in known and "." not in name and name.startswith("pileus_")
        if grows and (name in FROZEN or int(value) <= int(known[name])):
            wrong.append(f"{name} may not go from {known[name]} to {value}")
        elif name in known and not grows:
            wrong.append(f"{name} is there twice")
        known[name] = value
    return known, wrong, minor


def compare(record, printed):
    """Sentences about each difference."""
    known, wrong, minor = read_record(record)
    found = dict(line.split(" ", 1) for line in printed.splitlines())
    present = int(found.pop(MINOR))
    if present != minor:
        wrong.append(f"abi.h has minor {present}, the record ends with minor {minor}")
    for name, value in known.items():
        if name not in found:
            wrong.append(f"{name} is gone (it was {value})")
        elif found[name] != value:
            wrong.append(f"{name} was {value} and is {found[name]}")
    wrong += [f"{name} is new: {value}" for name, value in found.items() if name not in known]
    return wrong


ADVICE = """\
Plugins in use are built with the recorded values; interface 1.x only grows. Put back what has
changed or gone. What is new goes to the end of its table or enumeration, PILEUS_ABI_MINOR is raised
by one, and {record} gets a part '# minor N' at its end with the new lines and the new sizes
(docs/plugins/compatibility.md)."""


def main(record, program):
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    wrong = compare(Path(record).read_text(), printed)
    if wrong:
        sys.exit("\n".join(wrong) + "\n" + ADVICE.format(record=record))


if __name__ == "__main__":
    main(*sys.argv[1:])

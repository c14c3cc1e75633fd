"""What a header of the plugin contract declares, read from its text.

header.py layout OUT HEADER…        the C lines that print every size, offset and value
header.py next_minor OUT HEADER     the header as the next minor could be: every growing table has
                                    one member more at its end
"""
import re
import sys
from pathlib import Path

# Without `size`, or read from files: what the header says never changes.
FROZEN = {"pileus_view", "pileus_grid", "pileus_note"}
APPENDED = "appended_member"  # the host's is a function, the others' are numbers


def without_comments(text):
    return re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)


def tables(text):
    """The members of every struct, in order."""
    found = {}
    for body, name in re.findall(r"typedef struct \w+ \{(.*?)\} (\w+);", without_comments(text),
                                 flags=re.DOTALL):
        members = []
        for declaration in filter(None, map(str.strip, body.split(";"))):
            function = re.search(r"\(\*(\w+)\)\(", declaration)
            if function:
                members.append(function.group(1))
            else:
                members += [re.search(r"(\w+)\s*(\[\w+\])?$", part.strip()).group(1)
                            for part in declaration.split(",")]
        found[name] = members
    return found


def constants(text):
    """Names of numbers (enumerators, macros with a value) and of texts."""
    text = without_comments(text)
    numbers = []
    for body in re.findall(r"enum \{(.*?)\};", text, flags=re.DOTALL):
        numbers += [word.split("=")[0].strip() for word in body.split(",") if word.strip()]
    numbers += re.findall(r"#define (PILEUS_\w+) \d+u?\b", text)
    return numbers, re.findall(r'#define (PILEUS_\w+) "', text)


def layout(text):
    numbers, texts = constants(text)
    lines = []
    for table, members in tables(text).items():
        lines += [f"OFFSET({table}, {member})" for member in members] + [f"SIZE({table})"]
    lines += [f"NUMBER({name})" for name in numbers] + [f"TEXT({name})" for name in texts]
    return "\n".join(lines) + "\n"


def next_minor(text):
    """Raises the minor and lets every table grow that may."""
    raised, times = re.subn(r"(#define PILEUS_ABI_MINOR )(\d+)u",
                            lambda found: f"{found[1]}{int(found[2]) + 1}u", text)
    assert times == 1, "the header defines PILEUS_ABI_MINOR once"
    for table in tables(text).keys() - FROZEN:
        member = (f"uint64_t (*{APPENDED})(const struct pileus_host*);" if table == "pileus_host"
                  else f"uint64_t {APPENDED};")
        raised, times = re.subn(rf"\n\}} {table};", f"\n  {member}\n}} {table};", raised)
        assert times == 1, table
    return raised


def main(what, out, *headers):
    text = "\n".join(Path(header).read_text() for header in headers)
    made = {"layout": layout, "next_minor": next_minor}[what](text)
    Path(out).parent.mkdir(parents=True, exist_ok=True)
    Path(out).write_text(made)


if __name__ == "__main__":
    main(*sys.argv[1:])

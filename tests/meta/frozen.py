"""What of the plugin contract was released is never edited: its digests are on record."""
import hashlib
import re
from pathlib import Path

CONTRACT = "core/include/pileus/abi.h"
LAYOUT = "layout_v1.txt"  # grows by a part per minor: "layout_v1.txt:minor 0" is one of them


def layout_part(text, title):
    """The lines of a part, its heading included."""
    parts = re.split(r"^(?=# )", text, flags=re.MULTILINE)
    return next((part for part in parts if part.startswith(f"# {title}\n")), "")


def content(folder, name):
    """The bytes a line of the record is about; None when there are none."""
    file, _, title = name.partition(":")
    path = folder.parent / file if title else folder / file
    if not path.is_file():
        return None
    return layout_part(path.read_text(), title).encode() if title else path.read_bytes()


def frozen_contract(root):
    """Files of tests/abi/v<major>_<minor>/ have the digests of SHA256SUMS there, and as long as the
    minor is that of the folder, the present header is the released one."""
    root, found = Path(root), []
    folders = sorted((root / "tests/abi").glob("v[0-9]*_[0-9]*"))
    for folder in folders:
        record = (folder / "SHA256SUMS").read_text()
        for digest, name in (line.split("  ", 1) for line in record.splitlines()):
            bytes_now = content(folder, name)
            if bytes_now is None or hashlib.sha256(bytes_now).hexdigest() != digest:
                found.append(f"{folder}/{name}: was released and has changed; put it back")
    text = (root / CONTRACT).read_text()
    version = [re.search(rf"#define PILEUS_ABI_{part} (\d+)u", text)[1]
               for part in ("MAJOR", "MINOR")]
    released = root / "tests/abi" / "v{}_{}".format(*version) / "abi.h"
    if released.is_file() and released.read_text() != text:
        found.append(f"{root / CONTRACT}: is no longer {released}, the released one of its version; "
                     "a change raises PILEUS_ABI_MINOR (docs/plugins/compatibility.md)")
    return found

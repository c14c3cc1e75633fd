#!/usr/bin/env python3
"""Writes the seeds of the note and checkpoint fuzzers: seeds.py CORPUS.

note        the smallest shared library with a Pileus note and one exported symbol, and copies of it
            that are cut, or wrong in one place
checkpoint  recipes for checkpoints (see checkpoint_fuzzer.cpp), and files that are none
"""
import struct
import sys
from pathlib import Path

MACHINE_X86_64, SHARED_OBJECT = 62, 3
PROGBITS, STRTAB, NOBITS, DYNSYM = 1, 3, 8, 11
GLOBAL_FUNCTION = 0x12


def texts(*names):
    """A string table and the place of each name in it."""
    table, places = b"\0", []
    for name in names:
        places.append(len(table))
        table += name.encode() + b"\0"
    return table, places


def library():
    note = struct.pack("<16s4I64s32s64s64s", b"PILEUSNOTE1", 1, 0, 0, 0, b"org.example.seed",
                       b"1.0.0", b"GCC 12", b"")
    dynstr, (entry,) = texts("pileus_module_v1")
    symbols = bytes(24) + struct.pack("<IBBHQQ", entry, GLOBAL_FUNCTION, 0, 1, 0x1000, 16)
    names, places = texts(".pileus.note", ".dynsym", ".dynstr", ".shstrtab")
    content, sections = b"", [bytes(64)]
    parts = ((places[0], PROGBITS, note, 0, 0), (places[1], DYNSYM, symbols, 3, 24),
             (places[2], STRTAB, dynstr, 0, 0), (places[3], STRTAB, names, 0, 0))
    for name, kind, data, link, entry_size in parts:
        sections.append(struct.pack("<IIQQQQIIQQ", name, kind, 0, 0, 64 + len(content), len(data),
                                    link, 0, 1, entry_size))
        content += data
    header = struct.pack("<16sHHIQQQIHHHHHH", b"\x7fELF\x02\x01\x01", SHARED_OBJECT,
                         MACHINE_X86_64, 1, 0, 0, 64 + len(content), 0, 64, 0, 0, 64,
                         len(sections), len(sections) - 1)
    return header + content + b"".join(sections)


def with_bytes(data, at, new):
    return data[:at] + new + data[at + len(new):]


def main():
    corpus = Path(sys.argv[1])
    whole = library()
    table = len(whole) - 5 * 64  # of sections
    note = {
        "whole": whole,
        "empty": b"",
        "header_only": whole[:64],
        "cut_in_the_note": whole[:120],
        "cut_in_the_section_table": whole[:-32],
        "other_machine": with_bytes(whole, 18, b"\x03\x00"),
        "section_table_at_the_end_of_the_world": with_bytes(whole, 40, b"\xff" * 8),
        "note_without_contents": with_bytes(whole, table + 64 + 4, struct.pack("<I", NOBITS)),
        "note_too_short": with_bytes(whole, table + 64 + 32, struct.pack("<Q", 8)),
        "symbols_without_names": with_bytes(whole, table + 2 * 64 + 40, b"\xff" * 4),
        "symbols_of_odd_size": with_bytes(whole, table + 2 * 64 + 56, b"\x07"),
        "names_not_terminated": with_bytes(whole, 64 + 16 + 16, b"x" * 160),
    }
    numbers = struct.pack(">dd", 12.5, 0.25)
    checkpoint = {
        "nothing": b"\0",
        "no_file_of_ours": b"\0" + b"a text in its place",
        "hdf5_signature": b"\0\x89HDF\r\n\x1a\n" + bytes(64),
        "no_parcels": b"\x01\x00\x00\x00" + numbers,
        "parcels": b"\x01\x01\x01\x03" + bytes(range(240)) + numbers + b"\x05",
        "another_dimension": b"\x01\x00\x02\x02" + bytes(160) + numbers,
        "other_columns": b"\x01\x01\x00\x02" + bytes(160) + numbers,
        "names_and_values": b"\x01\x00\x00\x00" + numbers + b"\x07\x02a/b%\x00\x03" + bytes(8)
                            + b"\x01..\x01\x02\x09\x03x\x02\x7f\x04\x02\x05/\x02\x01",
        "not_numbers": b"\x01\x03\x03\x01" + b"\x7f\xf8" + b"\xff" * 60,
    }
    for folder, seeds in (("note", note), ("checkpoint", checkpoint)):
        (corpus / folder).mkdir(parents=True, exist_ok=True)
        for name, data in seeds.items():
            (corpus / folder / name).write_bytes(data)


if __name__ == "__main__":
    main()

"""Write ICDs with features that the ICDs of the project do not use, for Rust.

They have names of every length, ids beyond a byte, enumerations of every kind, and the
features of `tests.c.odd`.
"""

from __future__ import annotations

import json
from pathlib import Path

from tests.c import odd as odd_for_c

# Lengths of names at which rustfmt begins to break lines of the generated code.
LENGTHS = (1, 2, 9, *range(17, 41), 44, 48, *range(50, 57), 60)
# Some of them, for tests that do not depend on line breaks.
FEW_LENGTHS = (1, 9, 60)
BORROWED = (
    "Core",
    "Alloc",
    "Ok",
    "None",
    "From Bytes",
    "Bytes",
    "Vec",
    "String",
    "Option",
    "Copy",
    "Message",
    "i8",
    "f64",
    "bool",
)


def write(folder: Path) -> list[Path]:
    """Write all ICDs and return their files; included files come first."""
    return [*write_names(folder, FEW_LENGTHS), *odd_for_c.write(folder)]


def write_names(folder: Path, lengths: tuple[int, ...]) -> list[Path]:
    """Write ICDs in which every kind of name has each of these lengths."""
    base = _write(folder / "base.yaml", _base())
    return [base, _write(folder / "lengths.yaml", _lengths(lengths))]


def _write(path: Path, tree: dict) -> Path:
    path.write_text(json.dumps(tree), encoding="utf-8")  # JSON is YAML
    return path


def word(letter: str, length: int) -> str:
    """Return a name whose identifier has ``length`` characters."""
    if length % 10:
        return (letter * 9 + " ") * (length // 10) + letter * (length % 10)
    return word(letter, length - 1) + letter


def _base() -> dict:
    head = {
        "name": "base",
        "title": "Base",
        "byte_order": "big",
        "bit_order": "lsb0",
        "node_type": 300,
        "interface_version": 1,
    }
    dense = {
        "name": "Every Byte",
        "members": [{"value": n, "name": f"Value {n}"} for n in range(256)],
    }
    few = {
        "name": "One Value",
        "members": [{"value": 3, "name": "Unknown"}, {"value": 4, "name": "Unlisted"}],
    }
    gaps = {
        "name": "Gaps",
        "members": [{"value": n, "name": f"At {n}"} for n in (1, 5, 200, 70_000)],
    }
    fields = [
        {"at": 0, "bits": 8, "name": "Every", "type": "enum", "enum": "Every Byte"},
        {"at": 8, "bits": 3, "name": "One", "type": "enum", "enum": "One Value"},
        {"at": 11, "bits": 21, "name": "Gaps", "type": "enum", "enum": "Gaps"},
        {"at": 32, "bits": 8, "name": "One wide", "type": "enum", "enum": "One Value", "const": 4},
        {"at": 40, "bits": 8, "name": "Gaps narrow", "type": "enum", "enum": "Gaps", "special": [{"value": 5, "meaning": "five"}]},
        {"at": 48, "bits": 1, "name": "Flag", "type": "bool", "const": 1},
        {"at": 56, "bits": 640, "name": "Long array", "type": "text"},
        {"at": 696, "bits": 64, "name": "Limited", "type": "uint", "max": 18446744073709551615, "above": 0.5},
        {"at": 760, "bits": 13, "name": "Signed", "type": "int", "unit": "V", "formula": "raw*0.1", "min": -3.3, "below": 4,
         "special": [{"value": -1, "meaning": "?"}, {"value": -2, "meaning": "?"}]},
    ]  # fmt: skip
    messages = [
        {"name": "All Kinds", "kind": "configuration", "set_id": 1000, "get_id": 65535, "length": 97, "fields": fields},
        {"name": "Telemetry Of Base", "kind": "telemetry", "id": 5000, "length": 1,
         "fields": [{"at": 0, "bits": 8, "name": "x", "type": "uint"}]},
    ]  # fmt: skip
    return {
        "icdgen": 1,
        "node": head,
        "enums": [dense, few, gaps],
        "messages": messages,
    }


def _lengths(lengths: tuple[int, ...]) -> dict:
    """A message, fields of every kind, an enumeration and a member for each length of
    name.
    """
    head = {
        "name": "lengths",
        "title": "Lengths",
        "byte_order": "little",
        "bit_order": "lsb0",
    }
    messages, enums = [], []
    for number, length in enumerate(lengths):
        enum = word("e", length)
        members = [
            {"value": 0, "name": word("z", length)},
            {"value": 77_777, "name": word("m", length)},
        ]
        enums.append({"name": enum, "members": members})
        kinds = [
            ("a", {"bits": 8, "type": "uint"}),
            (
                "b",
                {
                    "bits": 16,
                    "type": "int",
                    "unit": "deg",
                    "formula": "raw*0.01",
                    "min": -100.25,
                },
            ),
            ("c", {"bits": 32, "type": "uint", "formula": "raw*-3 + 40"}),
            (
                "d",
                {
                    "bits": 64,
                    "type": "int",
                    "unit": "deg/s",
                    "formula": "raw/4294967295",
                },
            ),
            ("f", {"bits": 32, "type": "float", "unit": "m"}),
            ("g", {"bits": 64, "type": "float"}),
            ("h", {"bits": 24, "type": "enum", "enum": enum}),
            ("i", {"bits": 8, "type": "enum", "enum": "Every Byte", "const": 9}),
            ("j", {"bits": 400, "type": "bytes"}),
            ("k", {"bits": 1, "type": "bool"}),
            ("l", {"bits": 1, "type": "bool"}),
            ("n", {"bits": 1, "type": "bool"}),
            ("o", {"bits": 1, "type": "bool"}),
            ("p", {"bits": 7, "type": "int", "const": -3}),
            (
                "q",
                {
                    "bits": 13,
                    "type": "int",
                    "unit": "V",
                    "formula": "raw/8",
                    "special": [{"value": 1, "meaning": "one"}],
                },
            ),
            ("r", {"bits": 33, "type": "uint", "max": 5}),
            ("s", {"bits": 64, "type": "float"}),
            ("t", {"bits": 16, "type": "enum", "enum": "Gaps"}),
            ("u", {"bits": 8, "type": "int"}),
        ]
        fields, at = [], 0
        for letter, more in kinds:
            fields.append({"at": at, "name": word(letter, length), **more})
            at += more["bits"]
        kind = ("telecommand", "telemetry")[number % 2]
        messages.append(
            {
                "name": word("x", length),
                "kind": kind,
                "id": number,
                "length": -(-at // 8),
                "fields": fields,
            }
        )
    for number, name in enumerate(BORROWED):
        fields = [
            {
                "at": 0,
                "bits": 8,
                "name": name,
                "identifier": f"{name} x",
                "type": "uint",
            }
        ]
        messages.append(
            {
                "name": name,
                "kind": "telemetry",
                "id": 100 + number,
                "length": 1,
                "fields": fields,
            }
        )
    return {
        "icdgen": 1,
        "node": head,
        "include": ["base.yaml"],
        "enums": enums,
        "messages": messages,
    }


def write_long(folder: Path) -> list[Path]:
    """Names longer than any line; they must compile all the same."""
    return write_names(folder, (80, 120, 180))


def write_clashing(folder: Path) -> Path:
    """An ICD whose names clash with each other or with the generated code, in Rust."""
    head = {
        "name": "support",
        "title": "Support",
        "byte_order": "little",
        "bit_order": "lsb0",
    }
    fields = [
        {
            "at": 0,
            "bits": 8,
            "name": "Angle",
            "type": "uint",
            "unit": "deg",
            "formula": "raw*2",
        },
        {
            "at": 8,
            "bits": 8,
            "name": "Set Angle",
            "type": "uint",
            "unit": "deg",
            "formula": "raw*2",
        },
        {"at": 16, "bits": 8, "name": "Type", "type": "enum", "enum": "Words"},
    ]
    messages = [
        {"name": "Twins", "kind": "telemetry", "id": 1, "length": 3, "fields": fields},
        {"name": "Result", "kind": "telemetry", "id": 2, "length": 0},
        {"name": "Enums", "kind": "telemetry", "id": 3, "length": 0},
        {"name": "Str", "kind": "telemetry", "id": 4, "length": 0},
    ]
    enums = [
        {
            "name": "Words",
            "members": [{"value": 0, "name": "Self"}, {"value": 1, "name": "Ok"}],
        }
    ]
    return _write(
        folder / "clashing.yaml",
        {"icdgen": 1, "node": head, "enums": enums, "messages": messages},
    )


def write_least(folder: Path) -> Path:
    """A node of one telecommand without parameters."""
    head = {"name": "least", "title": "Least", "byte_order": "big", "bit_order": "msb0"}
    messages = [{"name": "Stop", "kind": "telecommand", "id": 1, "length": 0}]
    return _write(
        folder / "least.yaml", {"icdgen": 1, "node": head, "messages": messages}
    )

"""An ICD whose names have every length at which a line of generated code may become too
long.
"""

from __future__ import annotations

import json
from pathlib import Path

_TYPES = (
    {"bits": 16, "type": "uint", "formula": "raw*0.01", "unit": "deg"},
    {"bits": 16, "type": "int", "formula": "raw*3/7 + 1"},
    {"bits": 32, "type": "float"},
    {"bits": 64, "type": "float"},
    {"bits": 24, "type": "bytes"},
    {"bits": 24, "type": "uint"},
    {"bits": 40, "type": "int", "formula": "raw/3"},
    {"bits": 8, "type": "enum", "enum": "Mode"},
    {"bits": 16, "type": "enum", "enum": "Mode"},
    {"bits": 1, "type": "bool"},
    {"bits": 3, "type": "uint", "const": 3},
    {"bits": 12, "type": "int"},
    {"bits": 11, "type": "uint"},
    {"bits": 13, "type": "enum", "enum": "Mode"},
)


def write(folder: Path, lengths: range) -> Path:
    """Write the ICD to a file in ``folder`` and return its path."""
    messages, enums = (
        [],
        [{"name": "Mode", "members": [_member(length) for length in lengths]}],
    )
    for number, length in enumerate(lengths):
        messages.append(_message("m" * length, number, _TYPES, length))
        messages.append(
            _message(
                "n" * length, number + 100, _TYPES[number % len(_TYPES) :][:1], length
            )
        )
        enums.append({"name": "e" * length, "members": [{"value": 1, "name": "One"}]})
    enum_fields = [
        {"bits": 8, "type": "enum", "enum": enum["name"]} for enum in enums[1:]
    ]
    messages.append(_message("Enumerations", 250, enum_fields, 10))
    head = {
        "name": "lengths",
        "title": "Lengths",
        "byte_order": "little",
        "bit_order": "lsb0",
    }
    path = folder / "lengths.yaml"
    path.write_text(
        json.dumps({"icdgen": 1, "node": head, "enums": enums, "messages": messages}),
        encoding="utf-8",
    )
    return path


def _member(length: int) -> dict:
    return {"value": length, "name": "v" * length}


def _message(name: str, id: int, types, length: int) -> dict:
    fields, at = [], 0
    for number, keys in enumerate(types):
        if keys["bits"] not in (1, 3, 11, 12, 13):
            at = -(-at // 8) * 8
        suffix = "x" * (number + 1)
        fields.append({"at": at, "name": "f" * (length - len(suffix)) + suffix, **keys})
        at += keys["bits"]
    return {
        "name": name,
        "kind": "telemetry",
        "id": id,
        "length": -(-at // 8),
        "fields": fields,
    }

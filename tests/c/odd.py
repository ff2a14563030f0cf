"""Write ICDs with features that the ICDs of the project do not use.

They have every bit and byte order, random widths and positions, and texts that would
end a comment or string if they were not escaped.
"""

from __future__ import annotations

import json
import random
from pathlib import Path

ORDERS = [(byte, bit) for byte in ("little", "big") for bit in ("lsb0", "msb0")]
HOSTILE = [
    'ends a comment */ #error "out" /*',
    'a "quoted" name \\',
    "trigraphs ??/ ??= ??'",
    "braces {{ 7*7 }} {% raw %} {# no #}",
    "bell \x07 and backslash-newline \\\n#error out",
    "percent %s %n and \u202e right to left",
    "Größe 크기 ½°",
    "//\\",
]


def write(folder: Path) -> list[Path]:
    """Write a file for each combination of orders, and one with hostile text."""
    paths = []
    for byte_order, bit_order in ORDERS:
        name = f"odd_{byte_order}_{bit_order}"
        paths.append(
            _write(
                folder / f"{name}.yaml",
                _node(name, byte_order, bit_order, _messages(name)),
            )
        )
    paths.append(
        _write(
            folder / "hostile.yaml",
            {**_node("hostile", "little", "lsb0", _hostile()), **_hostile_enums()},
        )
    )
    paths.append(_write(folder / "silent.yaml", _node("silent", "little", "lsb0", [])))
    return paths


def _write(path: Path, tree: dict) -> Path:
    path.write_text(json.dumps(tree), encoding="utf-8")  # JSON is YAML
    return path


def _node(name: str, byte_order: str, bit_order: str, messages: list[dict]) -> dict:
    head = {
        "name": name,
        "title": name,
        "byte_order": byte_order,
        "bit_order": bit_order,
    }
    return {"icdgen": 1, "node": head, "messages": messages, "enums": [_WIDE_ENUM]}


_WIDE_ENUM = {
    "name": "Wide Mode",
    "members": [
        {"value": 0, "name": "Zero"},
        {"value": 0xFFFFFFFFFFFFFFFF, "name": "All"},
        {"value": 7, "name": "7"},
    ],
}
_WIDE_ENUM["members"][2]["identifier"] = "Seven"


def _messages(seed: str) -> list[dict]:
    generator = random.Random(seed)
    messages = [_random_message(generator, number) for number in range(8)]
    messages.append(_flags("Flags Up", range(40), 100))
    messages.append(
        _flags("Flags Down", [8 * (n // 8) + 7 - n % 8 for n in range(40)], 101)
    )
    messages.append(_flags("Flags Mixed", generator.sample(range(40), 40), 102))
    messages.append(_rows(103))
    messages.append({"name": "Nothing", "kind": "telecommand", "id": 104, "length": 0})
    messages.append(
        {"name": "Only Reserved", "kind": "telemetry", "id": 105, "length": 3}
    )
    return messages


def _flags(name: str, positions, number: int) -> dict:
    fields = [
        {"at": at, "bits": 1, "name": f"Flag {index}", "type": "bool"}
        for index, at in enumerate(positions)
    ]
    return {
        "name": name,
        "kind": "telemetry",
        "id": number,
        "length": 5,
        "fields": fields,
    }


def _rows(number: int) -> dict:
    fields, at = [], 0
    for bits, kinds in (
        (8, ("uint", "int")),
        (16, ("int", "uint")),
        (32, ("float", "int")),
        (64, ("uint", "float")),
    ):
        for index in range(9):
            fields.append(
                {
                    "at": at,
                    "bits": bits,
                    "name": f"Word {bits} {index}",
                    "type": kinds[index % 2],
                }
            )
            at += bits
    return {
        "name": "Rows",
        "kind": "telemetry",
        "id": number,
        "length": at // 8,
        "fields": fields,
    }


def _random_message(generator: random.Random, number: int) -> dict:
    fields, at = [], 0
    for index in range(14):
        at += generator.choice([0, 0, 0, 1, 3, 9])
        kind = generator.choice(
            ["uint", "int", "uint", "int", "bool", "enum", "float", "bytes", "text"]
        )
        bits = {
            "bool": 1,
            "float": generator.choice([32, 64]),
            "bytes": 8 * generator.randint(1, 5),
            "text": 8 * generator.randint(1, 9),
        }.get(kind)
        bits = bits or generator.choice([*range(1, 65), 8, 16, 24, 32, 40, 48, 56, 64])
        if kind in ("bytes", "text") or (bits % 8 == 0 and generator.random() < 0.5):
            at = -(-at // 8) * 8
        field = {"at": at, "bits": bits, "name": f"Field {index}", "type": kind}
        if kind == "enum":
            field["enum"] = "Wide Mode"
        if kind in ("uint", "int") and generator.random() < 0.6:
            field["formula"] = generator.choice(FORMULAS)
        fields.append(field)
        at += bits
    length = -(-at // 8) + generator.choice([0, 0, 2])
    return {"name": f"Odd {number}", "kind": "configuration", "set_id": number, "get_id": number, "length": length,
            "fields": fields}  # fmt: skip


FORMULAS = [
    "raw*0.01", "raw/3", "-raw*0.25", "(raw - 32)*5/9", "raw*4294967295 + 0.5", "raw/4294967295", "raw*7 - 100",
    "raw*1000", "raw*0.48828125", "raw*9007199254740993/4294967296*0.0000001", "-raw", "raw + 9223372036854775807",
    "raw*3 + 9223372036854775808", "raw - 9223372036854775808",
    "raw*0.000001 - 273.15",
]  # fmt: skip


def _hostile_enums() -> dict:
    members = [
        {"value": n, "name": text, "identifier": f"Value {n}"}
        for n, text in enumerate(HOSTILE)
    ]
    return {
        "enums": [
            {
                "name": HOSTILE[0],
                "identifier": "Bad Enum",
                "summary": HOSTILE[1],
                "members": members,
            }
        ]
    }


def _hostile() -> list[dict]:
    messages = []
    for number, text in enumerate(HOSTILE):
        fields = [
            {"at": 0, "bits": 12, "name": text, "identifier": "Bad Field", "type": "int", "formula": "raw*0.5",
             "summary": text, "const": 5, "special": [{"value": 7, "meaning": text}], "max": 3},
            {"at": 12, "bits": 8, "name": f"{text} again", "identifier": "Bad Mode", "type": "enum", "enum": HOSTILE[0]},
        ]  # fmt: skip
        messages.append({"name": text, "identifier": f"Bad {number}", "kind": "telemetry", "id": number, "length": 3,
                         "summary": text, "fields": fields})  # fmt: skip
    return messages

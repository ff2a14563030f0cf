"""Packets of the CYGNSS satellites, whose definitions lie among the tests of ccsdspy;
ccsdspy reads the frames and judges.
"""

from __future__ import annotations

import csv
import importlib.resources
import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.devices.definition import Definition, Definitions, node, unit

HEADER = 6  # bytes of the primary header: its fields are those of every packet
TYPES = {"U": "uint", "I": "int", "F": "float"}


def packets() -> Iterator[Definitions]:
    """All packets of the mission, by their APID."""
    import ccsdspy

    folder = importlib.resources.files(ccsdspy) / "tests" / "data" / "split" / "defs"
    assert isinstance(folder, Path)
    with open(folder / "Overview.csv", newline="", encoding="latin-1") as file:
        rows = [
            row for row in csv.reader(file) if len(row) > 2 and row[1].startswith("0x")
        ]
    files = {path.stem: path for path in folder.glob("*.csv")}
    messages = [
        _definition(row, _rows(files[row[0]])) for row in rows if row[0] in files
    ]
    yield Definitions(
        node("cygnss", "CYGNSS", id_bits=11, byte_order="big", bit_order="msb0"),
        messages,
    )


def _rows(path: Path) -> list[dict[str, str]]:
    with open(path, newline="", encoding="latin-1") as file:
        lines = list(csv.reader(file))
    heads = [head.strip() for head in lines[0]]
    return [
        dict(zip(heads, map(str.strip, line), strict=False))
        for line in lines[1:]
        if len(line) > 8
    ]


def _definition(overview: list[str], rows: list[dict[str, str]]) -> Definition:
    fields, cause, raw_only = [], "", ""
    length = int(overview[2]) - HEADER
    for row in rows:
        if not re.fullmatch(r"[UIF]\d+", row["Type"]):
            continue
        at = 8 * (int(row["Start Byte"]) - HEADER) + int(row["Start Bit"])
        if at < 0:
            continue
        kind, order = TYPES[row["Type"][0]], row["Type"][1:]
        one = {
            "at": at,
            "bits": int(row["Data Size"]),
            "name": row["Mnemonic"],
            "type": kind,
            **unit(row["Units"]),
        }
        if one["bits"] > 64:
            one["type"] = "bytes"
        if order[0] != "1":
            one |= {"byte_order": "little"}
        if re.search(r"\b(iif|ln)\(", row["Conversion Formula"], re.IGNORECASE):
            raw_only = "formulas with logarithms"
        elif row["Conversion Formula"]:
            one |= {"formula": _spelled(row["Conversion Formula"])}
        fields.append(one)
    if not fields:
        cause = "a packet without a table of fixed places"
    return Definition(
        overview[0],
        int(overview[1], 16),
        "telemetry",
        length,
        fields,
        cause=cause,
        raw=lambda data: _read(fields, data),
        raw_only=raw_only,
    )


def _spelled(formula: str) -> str:
    """A formula as an ICD spells it; some are the coefficients of a line, its constant
    first.
    """
    line = re.fullmatch(r"(\S+) (\S+)", formula)
    return (
        f"{line[1]} + raw*{line[2]}"
        if line
        else re.sub(r"\b[xX]\b", "raw", formula).strip('"')
    )


def _read(fields: list[dict], data: bytes) -> dict[str, object]:
    """What ccsdspy makes of a packet with this data.

    Of little-endian numbers it swaps the bytes of 16, 32 or 64 bits that hold them, so
    that those of another width, fills all of them, come out wider than they are: these
    are left out.
    """
    from ccsdspy import FixedLength, PacketField

    swapped = [
        one
        for one in fields
        if one.get("byte_order") == "little"
        and one["bits"] not in (*range(1, 9), 16, 32, 64)
    ]
    narrow = [one for one in fields if one["type"] != "bytes" and one not in swapped]
    columns: list[Any] = [
        PacketField(
            one["name"],
            one["type"],
            one["bits"],
            8 * HEADER + one["at"],
            one.get("byte_order", "big"),
        )
        for one in narrow
    ]
    header = bytes(4) + (len(data) - 1).to_bytes(2, "big")
    found = FixedLength(columns).load(io.BytesIO(header + data))
    return {one["name"]: found[one["name"]][0].item() for one in narrow}

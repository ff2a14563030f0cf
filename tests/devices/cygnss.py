"""Packets of the CYGNSS satellites, defined in the tests of ccsdspy and compared with
it.
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
    """Yield all packets of the mission, in the order of the overview."""
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
        # Positions count from the primary header, which an ICD of packets does not
        # describe.
        at = 8 * (int(row["Start Byte"]) - HEADER) + int(row["Start Bit"])
        if at < 0:
            continue
        kind, order = TYPES[row["Type"][0]], row["Type"][1:]
        field = {
            "at": at,
            "bits": int(row["Data Size"]),
            "name": row["Mnemonic"],
            "type": kind,
            **unit(row["Units"]),
        }
        if field["bits"] > 64:
            field["type"] = "bytes"
        if order[0] != "1":
            field |= {"byte_order": "little"}
        if re.search(r"\b(iif|ln)\(", row["Conversion Formula"], re.IGNORECASE):
            raw_only = "formulas with logarithms"
        elif row["Conversion Formula"]:
            field |= {"formula": _spelled(row["Conversion Formula"])}
        fields.append(field)
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
    """Return a formula in the notation of an ICD.

    Some are given as the two coefficients of a line, constant first.
    """
    line = re.fullmatch(r"(\S+) (\S+)", formula)
    return (
        f"{line[1]} + raw*{line[2]}"
        if line
        else re.sub(r"\b[xX]\b", "raw", formula).strip('"')
    )


def _read(fields: list[dict], data: bytes) -> dict[str, object]:
    """Return what ccsdspy decodes from a packet with this data.

    ccsdspy swaps the bytes of the 16, 32 or 64 bits that contain a little-endian
    number. Values of other widths have all bits of the container, and are left out.
    """
    from ccsdspy import FixedLength, PacketField

    swapped = [
        field
        for field in fields
        if field.get("byte_order") == "little"
        and field["bits"] not in (*range(1, 9), 16, 32, 64)
    ]
    narrow = [
        field for field in fields if field["type"] != "bytes" and field not in swapped
    ]
    columns: list[Any] = [
        PacketField(
            field["name"],
            field["type"],
            field["bits"],
            8 * HEADER + field["at"],
            field.get("byte_order", "big"),
        )
        for field in narrow
    ]
    header = bytes(4) + (len(data) - 1).to_bytes(2, "big")
    decoded = FixedLength(columns).load(io.BytesIO(header + data))
    return {field["name"]: decoded[field["name"]][0].item() for field in narrow}

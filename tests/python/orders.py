"""ICDs that no manual has: integers of every width at every bit, in all bit and byte
orders, some of their own.
"""

from __future__ import annotations

import json
import random
from pathlib import Path

ORDERS = [(byte, bit) for byte in ("little", "big") for bit in ("lsb0", "msb0")]


def write(folder: Path) -> Path:
    """One ICD an order; the folder."""
    for byte_order, bit_order in ORDERS:
        name = f"{byte_order}_{bit_order}"
        head = {
            "name": name,
            "title": name,
            "byte_order": byte_order,
            "bit_order": bit_order,
        }
        messages = [
            _message(random.Random(f"{name} {first}"), first) for first in range(8)
        ]
        enums = [
            {
                "name": "Wide",
                "members": [{"value": 0, "name": "Low"}, {"value": 1, "name": "High"}],
            }
        ]
        tree = {"icdgen": 1, "node": head, "enums": enums, "messages": messages}
        (folder / f"{name}.yaml").write_text(
            json.dumps(tree), encoding="utf-8"
        )  # JSON is YAML
    return folder


def _message(source: random.Random, first: int) -> dict:
    fields, at = [], first
    for bits in source.sample(range(1, 65), 64):
        kinds = ["uint", "int", "enum"]
        kinds += ["bool"] if bits == 1 else ["float"] if bits in (32, 64) else []
        field = {
            "at": at,
            "bits": bits,
            "name": f"Field {bits}",
            "type": source.choice(kinds),
        }
        if field["type"] == "enum":
            field["enum"] = "Wide"
        elif field["type"] in ("uint", "int") and bits <= 48 and source.random() < 0.5:
            field["formula"] = source.choice(
                ["raw*0.1", "raw/1000 - 40", "raw*-3/7", "raw*5 + 1", "0.25 - raw*1.5"]
            )
        if first % 2 and field["type"] != "bool" and source.random() < 0.4:
            field["byte_order"] = source.choice(("little", "big"))
        fields.append(field)
        at += bits
    at = -(-at // 8) * 8
    for size in (3, 17):
        fields.append(
            {"at": at, "bits": size * 8, "name": f"Bytes {size}", "type": "bytes"}
        )
        at += size * 8
    for size in (8, 16, 24, 32, 64, 32, 64):  # whole bytes in orders of their own
        field = {
            "at": at,
            "bits": size,
            "name": f"Word {at}",
            "type": "float" if size in (32, 64) and at % 16 else "int",
        }
        fields.append(
            field
            | {"byte_order": source.choice(("little", "big")), "bit_order": "msb0"}
        )
        at += size
    return {
        "name": f"From bit {first}",
        "kind": "telemetry",
        "id": first,
        "length": at // 8,
        "fields": fields,
    }

"""The shipped ICDs with another protocol: every choice that the format allows is made
the other way round.
"""

from __future__ import annotations

import copy
import dataclasses
from typing import Any

from icdgen.icd.model import Icd, Node, buses_of


def of(icd: Icd) -> Icd:
    """Return the same messages, big-endian, with bits counted from the top, under the
    odd protocol.
    """
    return Icd(tuple(_changed(node) for node in icd.nodes))


def _changed(node: Node) -> Node:
    protocol = copy.deepcopy(node.protocol)
    if buses := buses_of(protocol):
        buses["uart"]["framing"] |= {
            "escape": 0x10, "start": 2, "end": 3, "data": 0x11, "other": "ignore",
            "escaped_in": ["data"],
        }  # fmt: skip
        buses["can"]["segments"] |= {
            "fill": 0xA5,
            "packets_left_in_last": 1,
            "max_packets": 255,
            "max_bytes": 1785,
        }
        buses["can"]["node_address"] = 9
        protocol["link"]["checksums"]["crc16"] |= {
            "init": 0xFFFF,
            "reflect_in": True,
            "reflect_out": True,
            "xor_out": 0xFFFF,
        }
        for procedure in protocol["procedures"].values():
            _change_steps(procedure["steps"])
    for part in protocol.get("msdos_time", {}).get("parts", ()):
        if part["name"] == "hour":
            part["bits"] = 4
    link = protocol.get("link", {})
    for packet in link.get("packets", {}).values():
        for field in packet.get("trailer", ()):
            field["covers"]["from"] = "id"
            crc = link["checksums"][field["checksum"]]
            crc |= {"reflect_in": True, "reflect_out": True}
            crc.pop("empty", None)
    if "log_mask" in protocol:
        protocol["log_mask"] |= {"bit_order": "msb0", "fill": 0x77}
    return dataclasses.replace(
        node, byte_order="big", bit_order="msb0", protocol=protocol
    )


def _change_steps(steps: list[dict[str, Any]]) -> None:
    """Gives each step of procedures other facts."""
    for step in steps:
        if "missing" in step:
            step["missing"] |= {"first": 1, "fill": 0x5A}
        if "map" in step:
            step |= {"bit_order": "msb0", "received": 0, "beyond_end": 0}
        if "checksum" in step.get("verify", {}):
            verify = step["verify"]
            verify["covers_fill"] = not verify.get("covers_fill", False)
        for row in (step, step.get("blocks"), step.get("missing")):
            for key in ("repeat", "steps", "each"):
                _change_steps((row or {}).get(key, []))

"""Requests on I2C transactions and on the identification of the node."""

from __future__ import annotations

from random import Random

from icdgen_runtime.wire.i2c import i2c_write

from icdgen.protocol.facts import Facts
from icdgen.runtime_objects.operations import AnyLink
from icdgen.vectors.wire import Requests


def requests(link: AnyLink, facts: Facts, source: Random) -> Requests:
    """Yield requests on writes and reads, with and without a checksum."""
    for id, message in list(facts.telecommands.items())[:5]:
        for checked in (False, True) if facts.checksum else (False,):
            data = source.randbytes(message.length)
            request = {
                "op": "i2c_request",
                "kind": "telecommand",
                "id": id,
                "bytes": data.hex(),
                "crc": checked,
            }
            yield f"telecommand {id}", request
    for id, message in list(facts.telemetry.items())[:3]:
        frame = source.randbytes(message.length)
        for checked in (False, True) if facts.checksum else (False,):
            yield (
                f"telemetry {id}",
                {"op": "i2c_request", "kind": "telemetry", "id": id, "crc": checked},
            )
            # `i2c_write` begins with the id, which a reply does not repeat.
            data = i2c_write(link, id, frame, checked)[1:]
            about = {"op": "i2c_reply", "id": id, "crc": checked}
            yield f"telemetry {id}", {**about, "bytes": data.hex()}
            yield f"telemetry {id}, too short", {**about, "bytes": data[:-1].hex()}
            yield (
                f"telemetry {id}, one bit wrong",
                {**about, "bytes": (bytes([data[0] ^ 1]) + data[1:]).hex()},
            )
    step = facts.identification
    if step:
        for change in range(2):
            # The second frame identifies another node type.
            frame = bytes(
                [
                    (facts.node.node_type or 0) + change,
                    facts.node.interface_version or 0,
                ]
            )
            yield (
                "who the node is",
                {
                    "op": "identify",
                    "bytes": frame.ljust(step.message.length, b"\0").hex(),
                },
            )
        yield "a frame that is too short", {"op": "identify", "bytes": "00"}

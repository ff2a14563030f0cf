"""Scripts with the default time limits of the ICD, evaluated at each limit and one
millisecond before it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen_runtime.wire.i2c import i2c_write

from icdgen import codec
from icdgen.icd.buses import CAN, I2C, UART
from icdgen.icd.model import Message
from icdgen.protocol.facts import Facts
from icdgen.runtime_objects.links import with_outcome
from icdgen.runtime_objects.operations import AnyLink
from icdgen.vectors.wire import Requests


def scripts(link: AnyLink, facts: Facts) -> Requests:
    """Yield scripts of a client without settings."""
    frame = next(iter(facts.telemetry.values()), None)
    if frame is None:
        return
    waits = {UART: facts.framing, CAN: facts.can}
    request_row = {"at": 0, "telemetry": frame.telemetry_id}
    patience, tries = facts.client.reply_timeout, facts.client.retries + 1
    for bus in (bus for bus, form in waits.items() if form):
        rows = [
            {"at": patience * n + late} for n in range(1, tries + 1) for late in (-1, 0)
        ]
        yield (
            f"{bus}: silence",
            {
                "op": "client",
                "bus": bus,
                "script": [request_row, *rows, {"at": patience * (tries + 1)}],
            },
        )
    sent = next((m for m in facts.telecommands.values() if m.acknowledge), None)
    if sent is not None and facts.polled and facts.i2c_address is not None:
        for early in (1, 0):
            why = (
                "a millisecond before its time is over"
                if early
                else "when its time is over"
            )
            yield (
                f"{I2C}: not processed {why}",
                {
                    "op": "client",
                    "bus": I2C,
                    "script": list(_polls(link, facts, sent, early)),
                },
            )


def _polls(
    link: AnyLink, facts: Facts, sent: Message, early: int
) -> Iterator[dict[str, Any]]:
    """Yield a telecommand that is not processed within its time limit."""
    assert facts.polled
    polled, node = facts.polled, facts.node
    initial = codec.encode(node, polled, codec.initial_values(node, polled))
    data = with_outcome(link, initial, sent.telecommand_id or 0, False, 0, 0)
    state = i2c_write(link, polled.telemetry_id or 0, data, False)[1:].hex()
    yield {
        "at": 0,
        "telecommand": sent.telecommand_id,
        "bytes": bytes(sent.length).hex(),
    }
    yield {"at": 1, "receive": ""}
    pause, end = facts.client.poll_interval, 1 + facts.client.poll_timeout
    yield from (
        {"at": pause},
        {"at": 1 + pause},
        {"at": 2 + pause, "receive": state},
        {"at": 1 + 2 * pause},
    )
    poll_at = max(2 + 2 * pause, end - 2)
    last = max(poll_at, end - early)
    yield from ({"at": poll_at}, {"at": last, "receive": state}, {"at": last + pause})

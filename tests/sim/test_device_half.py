"""Responses that a device builds from the table of the link: the client interprets each
as intended.
"""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.device import response_to
from icdgen_runtime.wire.events import (
    Arrived,
    Done,
    Late,
    Progress,
    Refused,
    Reply,
    Stray,
)
from icdgen_runtime.wire.packet_formats import NumberPlace
from icdgen_runtime.wire.sender import Sender
from icdgen_runtime.wire.stream import StreamDecoder

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conformance.icds import LINKS, icd_of
from tests.conftest import ROOT

ICD = icd_of([ROOT / "examples" / "links", LINKS / "outcomes.yaml"])
EVENTS = {
    "ack": Done,
    "reply": Done,
    "nak": Refused,
    "busy": Progress,
    "progress": Progress,
}


def link(name: str):
    return link_of(ICD, facts.of(ICD, ICD.node(name)))


def commands(of):
    """Yield each telecommand that has responses, with their verdicts."""
    for row in of.stream.telecommands:
        if row.exchange is None:
            continue
        responses = of.stream.exchanges[row.exchange].responses
        yield (
            row,
            [
                verdict
                for verdict in EVENTS
                if any(
                    verdict
                    in ([r.verdict] if r.status is None else dict(r.meanings).values())
                    or (r.status is not None and verdict == r.verdict)
                    for r in responses
                )
            ],
        )


def sent(client: Client, id: int, data: bytes) -> bytes:
    """Return the bytes that a client sends for a telecommand."""
    client.start(0, Request("telecommand", id, data))
    return client.output()


@pytest.mark.parametrize(
    ("name", "expected_text"),
    [
        ("wheel", {"ack", "reply", "nak", "busy"}),
        ("arm", {"ack", "reply", "nak", "busy", "progress"}),
        ("receiver", {"reply"}),
    ],
)
def test_the_client_interprets_each_response(name, expected_text):
    of, seen = link(name), set()
    for row, verdicts in commands(of):
        data = bytes(range(7, 7 + row.least))
        for verdict in verdicts:
            client, device = Client(of), Sender(of, "telemetry")
            (event,) = StreamDecoder(of, "telecommand").feed(sent(client, row.id, data))
            response = response_to(of, event.id, event.data, verdict)
            (end,) = client.received(1, device.encode(*response))
            needed = [each for each in verdicts if each in ("ack", "reply")]
            expected = EVENTS[verdict]
            if len(needed) == 2 and verdict in needed:
                expected = Progress if verdict == "ack" else Reply
            assert type(end) is expected and end.id == row.id, (row, verdict, end)
            seen.add(verdict)
    assert seen == expected_text


@given(
    at=st.integers(0, 9),
    size=st.integers(1, 4),
    numbers=st.tuples(st.integers(0, 7), st.integers(1, 32), st.integers(0)),
    little=st.booleans(),
    data=st.binary(max_size=16),
)
def test_a_number_that_is_put_into_a_message_changes_no_other_bit(
    at, size, numbers, little, data
):
    shift, bits, number = numbers
    bits = min(bits, 8 * size - shift)
    place = NumberPlace(at, size, shift, bits, little)
    filled = bytearray(data)
    place.put(number % (1 << bits), filled)
    assert place.of(filled) == number % (1 << bits)
    place.put(place.of(data), filled)
    assert filled == data.ljust(max(len(data), at + size), b"\0")


@pytest.mark.parametrize("name", ["wheel", "arm"])
def test_the_response_to_another_telecommand_confirms_nothing(name):
    of = link(name)
    rows = [row for row, verdicts in commands(of) if "ack" in verdicts]
    for row, other in pairwise(rows):
        client = Client(of)
        assert sent(client, row.id, bytes(row.least))
        response = response_to(of, other.id, bytes(other.least))
        events = client.received(1, Sender(of, "telemetry").encode(*response))
        assert [type(event) for event in events] == [Stray] and client.busy
    assert len(rows) > 1


def test_a_nak_has_the_reason_and_the_other_fields_of_the_device():
    of = link("wheel")
    assert response_to(of, 0x02, b"\1\2\3", "nak", 3) == (0x15, b"\x02\x03")
    assert response_to(of, 0x04, b"", "reply", telemetry=b"\1\2") == (
        0x83,
        b"\1\2",
    )
    arm = link("arm")
    result, data = response_to(arm, 0x0207, b"", "ack") or (None, None)
    assert (result, data) == (None, None)  # Halt has no response
    frame = bytes.fromhex("ffffffff3412")  # all fields before the time are replaced
    _, data = response_to(arm, 0x0201, bytes(7), "ack", telemetry=frame)
    assert data == bytes.fromhex("f8ff02013412")


def test_a_telecommand_that_the_node_does_not_have_can_only_be_refused():
    of = link("wheel")
    assert response_to(of, 0x33, b"", "nak", 1) == (0x15, b"\x33\x01")
    assert response_to(of, 0x33, b"") is None
    assert response_to(link("receiver"), 0x0301, b"", "nak") is None


def test_a_reason_that_does_not_fit_is_an_error():
    with pytest.raises(RangeError, match="reason"):
        response_to(link("wheel"), 0x01, b"\0", "nak", 256)


def test_a_status_refuses_with_a_value_that_has_no_other_meaning():
    arm = link("arm")
    (row,) = (row for row in arm.stream.telecommands if row.id == 0x0205)
    client = Client(arm)
    assert sent(client, row.id, bytes(1))
    response = response_to(arm, row.id, bytes(1), "nak", 700)
    (end,) = client.received(1, Sender(arm, "telemetry").encode(*response))
    assert isinstance(end, Refused) and (end.code, end.reason) == (700, "Blocked")
    assert not isinstance(end, Late | Arrived)

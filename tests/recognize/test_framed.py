"""Pasted packets of framed links are decoded without header and trailer, and mistakes
in them are reported.
"""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.stream import stream_encode

from icdgen.protocol import facts
from icdgen.recognize import recognize
from icdgen.runtime_objects.links import link_of
from icdgen.values.errors import BadLength
from tests.conformance.icds import icd_of
from tests.conftest import ROOT

ICD = icd_of([ROOT / "examples" / "links"])


def sent(node: str, direction: str, id: int, data: bytes, **values: int) -> bytes:
    link = link_of(ICD, facts.of(ICD, ICD.node(node)))
    return stream_encode(link, id, data, direction, **values)


CASES = [
    ("receiver", "telemetry", 0x0122, bytes(range(20))),
    ("receiver", "telecommand", 0x0601, b"\1\2\3"),
    ("positioner", "telemetry", 0xFFFF, b"\1\0\0\0"),
    ("autopilot", "telemetry", 30, b"\1" * 28),
    ("payload", "telecommand", 0x64, b"\0\7"),
    ("logger", "telemetry", 0xC0, b"\xc0\1\xdb\2"),
    ("probe", "telecommand", 0x0200, b"\5"),
]


@pytest.mark.parametrize(("node", "direction", "id", "data"), CASES)
@pytest.mark.parametrize("is_named", [False, True])
def test_a_frame_is_found_with_its_node_direction_and_message(
    node, direction, id, data, is_named
):
    (decoded,) = recognize(
        ICD, sent(node, direction, id, data).hex(" "), node if is_named else None
    )
    assert (decoded.endpoint.node.name, decoded.what, decoded.id, decoded.data) == (
        node,
        direction,
        id,
        data,
    )
    assert decoded.frame.data == data and "header with id" in decoded.remarks[0]


def test_all_messages_of_a_recorded_stream_are_decoded_and_errors_reported():
    clock, epoch = (
        sent("receiver", "telemetry", 0x0122, bytes(20)),
        sent("receiver", "telemetry", 0x0161, bytes(4)),
    )
    first, second = recognize(ICD, b"\x00\xb5" + clock + epoch[:-1] + b"\0" + epoch)
    assert [frame.message.name for frame in (first, second)] == [
        "Navigation Clock",
        "End of Epoch",
    ]
    wrong = "a packet of receiver, `End of Epoch` (telemetry 01 61) has a wrong checksum: it is 66 00, expected 66 C7"
    assert first.left_out == (wrong,) and f"left out: {wrong}" in first.remarks
    assert any(
        "14 bytes around the frame belong to none" in remark for remark in first.remarks
    )


def test_header_values_that_the_sender_chose_are_shown():
    (decoded,) = recognize(
        ICD, sent("autopilot", "telemetry", 30, bytes(28), source=7, sequence=9).hex()
    )
    assert "source 7" in decoded.remarks[0] and "sequence 9" in decoded.remarks[0]


def test_a_wrong_checksum_is_reported_and_the_data_not_decoded():
    line = bytearray(sent("receiver", "telemetry", 0x0161, bytes(4)))
    line[-1] ^= 1
    with pytest.raises(
        BadLength,
        match=r"`End of Epoch` \(telemetry 01 61\) has a wrong checksum: it is 66 C6, expected 66 C7",
    ):
        recognize(ICD, bytes(line))


def test_bare_data_are_decoded():
    (decoded,) = recognize(ICD, "01 00 00 00", "receiver", "End of Epoch")
    assert decoded.data == b"\1\0\0\0"

"""Frames of a node with ids of several bytes start with the id, most significant byte
first.
"""

from __future__ import annotations

import pytest

from icdgen.loading import load
from icdgen.recognize import recognize
from icdgen.values.errors import BadLength, NotFound

ICD = """\
icdgen: 1
node: {name: receiver, title: Receiver, byte_order: little, bit_order: lsb0, id_bits: BITS}
messages:
  - name: Clock
    id: [ID]
    kind: telemetry
    length: 4
    fields:
      - {at: 0, bits: 32, name: Time, type: uint}
"""
WIDTHS = {
    11: ("0x01, 0x22", "01 22"),
    16: ("0xF1, 0x22", "F1 22"),
    24: ("1, 2, 3", "01 02 03"),
    32: ("9, 8, 7, 6", "09 08 07 06"),
}


@pytest.fixture(params=WIDTHS)
def receiver(request, tmp_path):
    written, sent = WIDTHS[request.param]
    path = tmp_path / "receiver.yaml"
    path.write_text(
        ICD.replace("BITS", str(request.param)).replace("ID", written), encoding="utf-8"
    )
    loaded = load([path])
    assert loaded.findings == []
    return loaded.icd, sent


def test_the_leading_id_selects_the_message(receiver):
    icd, sent = receiver
    (decoded,) = recognize(icd, f"{sent} 01 00 00 00")
    assert decoded.message.name == "Clock" and decoded.data == bytes([1, 0, 0, 0])
    assert decoded.id == decoded.message.id == int(sent.replace(" ", ""), 16)


def test_the_id_is_removed_if_the_message_is_named(receiver):
    icd, sent = receiver
    (decoded,) = recognize(icd, f"{sent} 01 00 00 00", "receiver", "Clock")
    assert (
        decoded.data == bytes([1, 0, 0, 0])
        and f"id {decoded.id} removed" in decoded.frame.remarks
    )


def test_bare_data_are_recognised_by_their_length(receiver):
    (decoded,) = recognize(receiver[0], "01 00 00 00")
    assert (decoded.message.name, decoded.id) == ("Clock", None)


def test_an_unknown_id_and_a_wrong_length_are_different_errors(receiver):
    icd, sent = receiver
    with pytest.raises(NotFound, match="no message of receiver has the id"):
        recognize(icd, "00 00 00 00 00 00 00")
    with pytest.raises(BadLength, match="has 4 bytes, 3 given after the id"):
        recognize(icd, f"{sent} 01 02 03")
    with pytest.raises(BadLength, match=r"an id of receiver has \d bytes, 1 given"):
        recognize(icd, "01")

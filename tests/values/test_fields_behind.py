"""Fields after a variable-length field on the command line."""

from __future__ import annotations

import pytest

from icdgen.loading import load
from icdgen.values import encode
from icdgen.values.errors import BadValue
from icdgen.values.frame import decoded_frame
from tests.conformance import odd


@pytest.fixture(scope="module")
def icd():
    return load([odd.FOLDER / "behind.yaml"]).icd


@pytest.mark.parametrize(
    ("message", "values", "expected"),
    [
        ("Packet", ["sender=1", "payload=aa bb", "crc=0x1234"], "0001 aabb 3412"),
        ("Packet", ["sender=1", "payload=", "crc=0x1234"], "0001 3412"),
        ("Sentence", ["words=ok", "codes=[1, 2]"], "05 6f6b 010200 03"),
        ("Counted", ["samples=[]", "sum=7"], "00 07"),
        ("Counted", ["sum=7", "samples=[1, 2]"], "02 0102 07"),
        ("Nothing in front", ["values=[-1]", "time=1"], "ffff 3f800000"),
    ],
)
def test_a_field_is_sent_after_the_given_elements(icd, message, values, expected):
    encoded = encode.encode(icd, "behind", message, values)
    assert encoded.data == bytes.fromhex(expected)
    assert (
        decoded_frame(icd, encoded.node, encoded.message, encoded.data).rows
        == encoded.rows
    )


def test_a_field_after_an_array_is_required(icd):
    with pytest.raises(BadValue, match="no value for `CRC`"):
        encode.encode(icd, "behind", "Packet", ["sender=1", "payload=aa"])

"""Fields behind a part of variable length, as people give and read them."""

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
def test_a_field_is_sent_behind_the_elements_that_are_given(
    icd, message, values, expected
):
    given = encode.encode(icd, "behind", message, values)
    assert given.data == bytes.fromhex(expected)
    assert decoded_frame(icd, given.node, given.message, given.data).rows == given.rows


def test_a_field_behind_must_be_given(icd):
    with pytest.raises(BadValue, match="no value for `CRC`"):
        encode.encode(icd, "behind", "Packet", ["sender=1", "payload=aa"])

"""Messages of variable length, as people give and read them."""

from __future__ import annotations

import pytest

from icdgen.loading import load
from icdgen.recognize import recognize
from icdgen.values import encode
from icdgen.values.errors import BadLength, BadValue
from tests.conformance import odd


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    folder = tmp_path_factory.mktemp("open")
    (folder / "open.yaml").write_text(odd.OPEN, encoding="utf-8")
    return load([folder]).icd


def frame(icd, message, *values):
    return encode.encode(icd, "open", message, list(values)).data.hex()


@pytest.mark.parametrize(
    ("message", "values", "expected"),
    [
        ("Narrow", ["number=3", "samples=[0, 0]"], "03" + "00" * 6),
        ("Narrow", ["number=3", "samples=[]"], "03"),
        ("Text", ["severity=1", "match=hi"], "00016869"),
        ("Text", ["severity=1", "match="], "0001"),
        ("Payload", ["data=01 02 ff"], "0102ff"),
        ("Gauges", ["gauges=[Last, First]"], "0200012c0001"),
        ("Lengthy", ["fn=[1,2,3]"], "010203"),
        ("Fives", ["fives[0]=7"], "090000000007"),
    ],
)
def test_what_is_given_is_counted(icd, message, values, expected):
    assert frame(icd, message, *values) == expected


@pytest.mark.parametrize(
    ("message", "values", "said"),
    [
        ("Narrow", ["number=3"], "no value for `Samples`"),
        ("Narrow", ["number=3", "samples=[0,0,0,0,0,0]"], "up to 5 values"),
        ("Narrow", ["number=3", "samples[1]=0"], "not all elements before it"),
        ("Gauges", ["gauges=[First]", "gauges count=2"], "`Gauges Count` is 2, and 1 element of `Gauges` is given"),
        ("Payload", [f"data={'00' * 256}"], "up to 255 bytes"),
        ("Text", ["severity=1", f"match={'x' * 81}"], "80 ASCII characters"),
    ],
)
def test_what_is_missing_or_too_much_is_said(icd, message, values, said):
    with pytest.raises(BadValue, match=said):
        frame(icd, message, *values)


def test_only_what_is_in_a_frame_is_shown(icd):
    (found,) = recognize(icd, "03 000001 ffffff", "open", "Narrow")
    assert [(row.field.name, row.raw) for row in found.frame.rows] == [
        ("Number", 3),
        ("Samples[0]", 0x010000),
        ("Samples[1]", -1),
    ]
    (found,) = recognize(icd, "0001 6869", "open", "Text")
    assert [row.text for row in found.frame.rows] == ["1", "hi"]
    assert found.frame.to_json()["length"] == 4


def test_a_frame_without_its_last_zeros_shows_all_fields(icd):
    (found,) = recognize(icd, "2f 60", "open", "Two")
    assert [(row.field.name, row.raw) for row in found.frame.rows] == [("Whole", 0b011110110)]
    (found,) = recognize(icd, "2f", "open", "Two")
    assert [row.raw for row in found.frame.rows] == [0b011110000]
    (found,) = recognize(icd, "8c 00 05", "open")  # 140
    assert found.message.name == "Cut Off" and len(found.frame.rows) == 18
    assert frame(icd, "Two", "whole=0") == "0000"


@pytest.mark.parametrize(
    ("message", "text", "said"),
    [
        ("Two", "00 00 00", "Two has 1 to 2 bytes, 3 given"),
        ("Narrow", "03 00", "Narrow has 1 to 16 bytes, 2 given"),
        ("Gauges", "0300 0001", "8 are needed for as many elements as `Gauges Count` says"),
        ("Gauges", "0000 0001", "2 are needed"),
    ],
)
def test_a_frame_of_another_length_than_it_says_is_refused(icd, message, text, said):
    with pytest.raises(BadLength, match=said):
        recognize(icd, text, "open", message)


def test_a_frame_is_found_by_its_id_if_its_count_is_right(icd):
    (found,) = recognize(icd, "86 0100 012c", "open")  # 134: Gauges
    assert found.message.name == "Gauges" and found.id == 134

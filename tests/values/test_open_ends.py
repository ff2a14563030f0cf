"""Messages of variable length on the command line."""

from __future__ import annotations

import pytest

from icdgen.loading import load
from icdgen.recognize import recognize
from icdgen.values import encode
from icdgen.values.errors import BadLength, BadValue
from tests.conformance import odd


@pytest.fixture(scope="module")
def icd():
    return load([odd.FOLDER / "open.yaml"]).icd


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
        ("Turned Structs", ["inners=[]"], ""),
        (
            "Turned Structs",
            [
                "inners[0].type=-2.75",
                "inners[0].flags=[1,0,0,1]",
                "inners[0].gauge=Last",
                "inners[0].text=x",
            ],
            "01902c0178",
        ),
    ],
)
def test_what_is_given_is_counted(icd, message, values, expected):
    assert frame(icd, message, *values) == expected


CURVE = [
    "between=First",
    "flags=[1,0,0,0,0,0,0,1]",
    "pair[0].v=0",
    "pair[1].v=0.1",
    "word=ab",
]


@pytest.fixture(scope="module")
def curves():
    return load([odd.FOLDER / "curves.yaml"]).icd


def given_curves(*values):
    """Return the input for two curves, which only differs in the values named after
    their curves.
    """
    return [
        *(f"curves[{number}].{value}" for number in (0, 1) for value in CURVE),
        *values,
    ]


def test_points_of_each_curve_are_counted_for_all(curves):
    points = [
        "curves[0].points[0].v=0.5",
        "curves[1].points[0].v=0.6",
        "curves[0].levels=[0.01]",
        "curves[1].levels[0]=0.02",
    ]
    frame = encode.encode(curves, "curves", "Curves", given_curves(*points))
    ends = "0001{:06x}810000fffe0001fffe616200"
    assert frame.data.hex() == "01000002" + "00070005fffe" + ends.format(
        1
    ) + "00070006fffe" + ends.format(2)
    assert {row.field.name: row.raw for row in frame.rows}["Points Count"] == 1


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (
            [
                "curves[0].points[0].v=1",
                "curves[0].levels[0]=0",
                "curves[1].levels[0]=0",
            ],
            r"`Curves\[1\].Points\[0\].V`",
        ),
        (
            [
                "curves[0].points[1].v=1",
                "curves[0].levels[0]=0",
                "curves[1].levels[0]=0",
            ],
            r"`Curves\[0\].Points\[0\].V`",
        ),
        (
            ["points count=1", "curves[0].points[1].v=1"],
            "`Points Count` is 1, so `Points` has 1 element, 2 given",
        ),
        (["points count=0"], r"no value for `Curves\[0\].Levels\[0\]`"),
    ],
)
def test_missing_points_of_a_curve_are_reported(curves, values, expected):
    with pytest.raises(BadValue, match=expected):
        encode.encode(curves, "curves", "Curves", given_curves(*values))


@pytest.mark.parametrize(
    ("message", "values", "expected"),
    [
        ("Narrow", ["number=3"], "no value for `Samples`"),
        ("Narrow", ["number=3", "samples=[0,0,0,0,0,0]"], "up to 5 values"),
        ("Narrow", ["number=3", "samples[1]=0"], "not all elements before it"),
        ("Turned Structs", [], "no value for `Inners`"),
        (
            "Turned Structs",
            ["inners[0].gauge=First"],
            r"no value for `Inners\[0\].Type`, `Inners\[0\].Flags\[0\]`",
        ),
        ("Turned Structs", ["inners=[1]"], "is made of structs"),
        (
            "Gauges",
            ["gauges=[First]", "gauges count=2"],
            "`Gauges Count` is 2, and 1 element of `Gauges` is given",
        ),
        ("Payload", [f"data={'00' * 256}"], "up to 255 bytes"),
        ("Text", ["severity=1", f"match={'x' * 81}"], "80 ASCII characters"),
    ],
)
def test_missing_and_surplus_elements_are_reported(icd, message, values, expected):
    with pytest.raises(BadValue, match=expected):
        frame(icd, message, *values)


def test_only_elements_in_the_frame_are_shown(icd):
    (decoded,) = recognize(icd, "03 000001 ffffff", "open", "Narrow")
    assert [(row.field.name, row.raw) for row in decoded.frame.rows] == [
        ("Number", 3),
        ("Samples[0]", 0x010000),
        ("Samples[1]", -1),
    ]
    (decoded,) = recognize(icd, "0001 6869", "open", "Text")
    assert [row.text for row in decoded.frame.rows] == ["1", "hi"]
    assert decoded.frame.to_json()["length"] == 4


def test_a_frame_without_its_last_zeros_shows_all_fields(icd):
    (decoded,) = recognize(icd, "2f 60", "open", "Two")
    assert [(row.field.name, row.raw) for row in decoded.frame.rows] == [
        ("Whole", 0b011110110)
    ]
    (decoded,) = recognize(icd, "2f", "open", "Two")
    assert [row.raw for row in decoded.frame.rows] == [0b011110000]
    (decoded,) = recognize(icd, "8c 00 05", "open")  # 140
    assert decoded.message.name == "Cut Off" and len(decoded.frame.rows) == 18
    assert frame(icd, "Two", "whole=0") == "0000"


@pytest.mark.parametrize(
    ("message", "text", "expected"),
    [
        ("Two", "00 00 00", "Two has 1 to 2 bytes, 3 given"),
        ("Narrow", "03 00", "Narrow has 1 to 16 bytes, 2 given"),
        (
            "Gauges",
            "0300 0001",
            "8 are needed for as many elements as `Gauges Count` says",
        ),
        ("Gauges", "0000 0001", "2 are needed"),
    ],
)
def test_a_frame_of_another_length_than_it_says_is_refused(
    icd, message, text, expected
):
    with pytest.raises(BadLength, match=expected):
        recognize(icd, text, "open", message)


def test_a_frame_is_found_by_its_id_if_its_count_is_right(icd):
    (decoded,) = recognize(icd, "86 0100 012c", "open")  # 134: Gauges
    assert decoded.message.name == "Gauges" and decoded.id == 134


def test_structs_that_are_not_in_a_frame_are_not_shown(icd):
    (decoded,) = recognize(icd, "01 90 2c 01 78", "open", "Turned Structs")
    assert [row.field.name for row in decoded.frame.rows] == [
        "Inners[0].Type",
        *(f"Inners[0].Flags[{index}]" for index in range(4)),
        "Inners[0].Gauge",
        "Inners[0].Text",
    ]

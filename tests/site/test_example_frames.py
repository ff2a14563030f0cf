"""Example frames on the page of a message: each value is shown in the format of its
field.
"""

from __future__ import annotations

from icdgen.backends.html.examples import example_frames, page_vectors
from tests.icd.files import loaded, status
from tests.limits import assert_limits

MODE = "enums: [{name: Mode, members: [{value: 255, name: Idle}]}]\n"
FIELDS = (
    "at: 0, bits: 8, name: Mode, type: enum, enum: Mode",
    "at: 8, bits: 1, name: Flag, type: bool",
    "at: 16, bits: 16, name: Speed, type: int, unit: rpm, formula: raw*0.5",
    "at: 32, bits: 32, name: Level, type: float",
    "at: 64, bits: 32, name: Angle, type: float, display: {digits: 2}",
    "at: 96, bits: 16, name: Mask, type: uint, display: hex",
    "at: 112, bits: 8, name: Plain, type: uint",
    "at: 120, bits: 16, name: Label, type: text",
    "at: 136, bits: 16, name: Data, type: bytes",
)


def test_the_values_of_each_type_are_shown_in_its_format(tmp_path):
    icd = loaded(tmp_path, MODE + status(*FIELDS, length=19)).icd
    (node,) = icd.nodes
    some, ones = example_frames(node.messages[0], node)
    assert [tuple(cell) for cell in ones.cells] == [
        ("255", "Idle"),
        ("1", "true"),
        ("\N{MINUS SIGN}1", "\N{MINUS SIGN}0.5"),
        ("0xFFFFFFFF", "nan"),
        ("0xFFFFFFFF", "nan"),
        ("0xFFFF", ""),
        ("255", ""),
        ("FF FF", "\ufffd\ufffd"),
        ("FF FF", ""),
    ]
    assert (ones.why, ones.hex) == ("all ones", " ".join(["FF"] * 19))
    assert (some.why, some.frame) == ("random 0", bytes.fromhex(some.hex))
    assert [tuple(cell) for cell in some.cells] == [
        ("104", "no member"),
        ("0", "false"),
        ("26093", "13046.5"),
        ("0xB618EA93", "\N{MINUS SIGN}2.2786305e\N{MINUS SIGN}06"),
        ("0x54830D32", "4500000000000"),
        ("0xB31D", ""),
        ("39", ""),
        ("09 5A", " Z"),
        ("D1 9F", ""),
    ]


def test_an_absent_field_is_named_and_an_array_has_all_elements(tmp_path):
    text = status(
        "at: 0, bits: 8, name: Page, type: uint",
        "at: 8, bits: 8, name: Wear, type: uint, when: {Page: 255}",
        "at: 8, bits: 8, name: Hours, type: uint, when: {Page: 1}",
        "at: 16, bits: 8, name: Number, type: uint",
        "at: 24, bits: 8, name: Items, type: uint, count: Number, up_to: 3",
        length=3,
    )
    (node,) = loaded(tmp_path, text).icd.nodes
    _, ones = example_frames(node.messages[0], node)
    assert ones.hex == "FF FF 03 FF FF FF"
    assert [tuple(cell) for cell in ones.cells] == [
        ("255", ""),
        ("255", ""),
        ("", "not there"),
        ("3", ""),
        ("255", ""),
        ("255", ""),
        ("255", ""),
    ]


def test_sixteen_bytes_of_a_field_are_shown(tmp_path):
    def is_complete(length: int) -> bool:
        field = f"at: 0, bits: {8 * length}, name: Data, type: bytes"
        icd = loaded(tmp_path, status(field, length=length)).icd
        (node,) = icd.nodes
        for frame in example_frames(node.messages[0], node):
            (cell,) = frame.cells
            expected = frame.hex if length <= 16 else f"{frame.hex[:47]} \u2026"
            assert cell.raw == expected
        return "\u2026" not in cell.raw

    assert_limits(is_complete, most=16)


def test_the_values_of_at_most_60_fields_are_shown(tmp_path):
    def has_values(count: int) -> bool:
        fields = [
            f"at: {8 * index}, bits: 8, name: Level {index}, type: uint"
            for index in range(count)
        ]
        icd = loaded(tmp_path, status(*fields, length=count)).icd
        (node,) = icd.nodes
        frames = example_frames(node.messages[0], node)
        assert {len(frame.cells) for frame in frames} <= {0, count}
        return bool(frames[0].cells)

    assert_limits(has_values, most=60)


def test_a_message_without_bytes_has_no_frames(tmp_path):
    text = "messages: [{name: Reset, id: 1, kind: telecommand, length: 0}]\n"
    (node,) = loaded(tmp_path, text).icd.nodes
    assert example_frames(node.messages[0], node) == []
    assert page_vectors(node.messages[0], node) == ([], True)


def test_frames_of_a_page_have_at_most_64_kib_together(tmp_path):
    """The first frame is shown, however long it is."""
    for length in (0xFFFF, 0x8000, 0x3000):
        field = f"at: 0, bits: {8 * length}, name: Data, type: bytes"
        (node,) = loaded(tmp_path, status(field, length=length)).icd.nodes
        rows, are_all = page_vectors(node.messages[0], node)
        assert (len(rows), are_all) == (0x10000 // length, False)

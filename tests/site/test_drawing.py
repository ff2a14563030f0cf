"""Drawing of a frame: each bit is at its position, with the numbers of the ICD."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from icdgen.backends.html.drawing import FrameDrawing, bytes_a_row, draw_frame, hatch
from icdgen.backends.html.links import Links
from tests.icd.files import loaded, status
from tests.limits import assert_limits

HEAD = (
    "icdgen: 1\nnode: {{name: demo, title: Demo, byte_order: little, bit_order: {}}}\n"
)
FIELDS = (
    "at: 0, bits: 8, name: Mode, type: uint",
    "at: 16, bits: 12, name: Level, type: uint",
    "at: {flag}, bits: 1, name: Flag, type: bool",
    "at: 32, bits: 16, name: Speed, type: int",
    "at: 48, bits: 400, name: Data, type: bytes",
)


def drawing(
    folder: Path, *part: int, length: int = 56, bit_order: str = "lsb0"
) -> FrameDrawing:
    """Draw the bytes of a part (default: all) of a message with these fields."""
    flag = 28 if bit_order == "lsb0" else 31
    fields = FIELDS[: 5 if length > 6 else 4]
    text = status(*(field.format(flag=flag) for field in fields), length=length)
    icd = loaded(folder, HEAD.format(bit_order) + text).icd
    (node,) = icd.nodes
    drawn = draw_frame(node.messages[0], node, Links(icd), *part)
    assert drawn is not None
    return drawn


def boxes(drawn: FrameDrawing) -> dict[str, list[tuple[int, int, int, int]]]:
    """Return the rectangles of each field by its title; those of reserved bits last."""
    return {shape.title: shape.rects for shape in [*drawn.shapes, *drawn.reserved]}


def test_a_section_that_begins_later_has_the_byte_and_bit_numbers_of_the_frame(
    tmp_path,
):
    drawn = drawing(tmp_path, 2, 6)
    assert drawn.rows == [
        (24, "2", "16"),
        (70, "3", "24"),
        (116, "4", "32"),
        (162, "5", "40"),
    ]
    assert [number for _, number in drawn.columns] == list("76543210")
    assert boxes(drawn) == {
        "Level: bits 16 to 27": [(64, 24, 936, 46), (532, 70, 468, 46)],
        "Flag: bit 28": [(415, 70, 117, 46)],
        "Speed: bits 32 to 47": [(64, 116, 936, 92)],
        "Reserved: bits 29 to 31": [(64, 70, 351, 46)],
    }
    assert drawn.height == 210 and not drawn.skips


def test_the_rows_between_the_ends_of_a_long_field_are_omitted(tmp_path):
    drawn = drawing(tmp_path)
    assert drawn.rows == [
        (24, "0", "0"),
        (54, "4", "32"),
        (84, "8", "64"),
        (144, "52", "416"),
    ]
    assert drawn.skips == [(114, "40 more bytes")]
    assert [int(number) for _, number in drawn.columns] == [
        8 * byte + bit for byte in range(4) for bit in reversed(range(8))
    ]
    assert boxes(drawn) == {
        "Mode: bits 0 to 7": [(64, 24, 234, 30)],
        "Level: bits 16 to 27": [(532, 24, 234, 30), (883, 24, 117, 30)],
        "Flag: bit 28": [(854, 24, 29, 30)],
        "Speed: bits 32 to 47": [(64, 54, 468, 30)],
        "Data: bits 48 to 447": [(532, 54, 468, 30), (64, 84, 936, 90)],
        "Reserved: bits 8 to 15, bits 29 to 31": [(298, 24, 234, 30), (766, 24, 88, 30)],
    }  # fmt: skip
    # The name of a flag does not fit into its box.
    assert drawn.keyed
    assert [
        label.text for shape in drawn.shapes for label in shape.labels if label.key
    ] == ["3"]


def test_three_rows_of_a_field_are_drawn_and_of_four_the_middle_ones_are_omitted(
    tmp_path,
):
    """Two bytes of the data are in a row."""
    assert_limits(lambda rows: not drawing(tmp_path, 6, 6 + 2 * rows).skips, most=3)


@pytest.mark.parametrize(
    ("bit_order", "numbers"),
    [("lsb0", "7 6 5 4 3 2 1 0"), ("msb0", "0 1 2 3 4 5 6 7")],
)
def test_the_columns_have_the_bit_numbers_of_the_icd(tmp_path, bit_order, numbers):
    """The most significant bit is on the left for either bit order."""
    drawn = drawing(tmp_path, length=6, bit_order=bit_order)
    assert [number for _, number in drawn.columns] == numbers.split()
    assert [x for x, _ in drawn.columns] == [
        122.5, 239.5, 356.5, 473.5, 590.5, 707.5, 824.5, 941.5,
    ]  # fmt: skip
    flag = boxes(drawn)[f"Flag: bit {28 if bit_order == 'lsb0' else 31}"]
    column = 3 if bit_order == "lsb0" else 7
    assert flag == [(64 + 117 * column, 162, 117, 46)]


def test_reserved_bits_across_two_parts_are_named_in_each_up_to_its_end(tmp_path):
    """Two contained messages can meet in reserved bits."""
    text = status(
        "at: 0, bits: 12, name: Level, type: uint",
        "at: 28, bits: 4, name: Speed, type: uint",
        length=4,
    )
    icd = loaded(tmp_path, text).icd
    (node,) = icd.nodes
    titles = [
        list(boxes(drawn))
        for first, end in ((0, 2), (2, 3), (2, 4))
        if (drawn := draw_frame(node.messages[0], node, Links(icd), first, end))
    ]
    assert titles == [
        ["Level: bits 0 to 11", "Reserved: bits 12 to 15"],
        ["Reserved: bits 16 to 23"],
        ["Speed: bits 28 to 31", "Reserved: bits 16 to 27"],
    ]


def test_a_part_draws_the_fields_that_reach_into_it(tmp_path):
    def is_drawn(bits: int) -> bool:
        text = status(f"at: 16, bits: {bits}, name: Level, type: uint", length=8)
        (node,) = (icd := loaded(tmp_path, text).icd).nodes
        drawn = draw_frame(node.messages[0], node, Links(icd), 5, 6)
        return drawn is not None and bool(drawn.shapes)

    assert_limits(is_drawn, least=3 * 8 + 1)


def test_optional_fields_at_the_same_bits_share_a_box_with_all_names(tmp_path):
    """Up to three alternatives are named. Overlays are not drawn: other fields have
    their bits.
    """
    text = status(
        "at: 0, bits: 8, name: Page, type: uint",
        "at: 8, bits: 8, name: Wear, type: uint, when: {Page: 0}",
        "at: 16, bits: 8, name: Load, type: uint, when: {Page: 0}",
        "at: 8, bits: 16, name: Hours, type: uint, when: {Page: 1}",
        *(
            f"at: 8, bits: 8, name: Spare {page}, type: uint, when: {{Page: {page}}}"
            for page in (2, 3, 4)
        ),
        "at: 24, bits: 8, name: Low, type: uint",
        "at: 24, bits: 4, name: Nibble, type: uint, view: true",
        length=4,
    )
    icd = loaded(tmp_path, text).icd
    (node,) = icd.nodes
    drawn = draw_frame(node.messages[0], node, Links(icd))
    assert drawn is not None and boxes(drawn) == {
        "Page: bits 0 to 7": [(64, 24, 936, 34)],
        "Wear / Hours / Spare 2 / Spare 3: bits 8 to 15": [(64, 58, 936, 34)],
        "Load / Hours: bits 16 to 23": [(64, 92, 936, 34)],
        "Low: bits 24 to 31": [(64, 126, 936, 34)],
    }


def test_lines_separate_fields_and_cross_none(tmp_path):
    """The level continues in the second row, so that no line is above it there."""
    drawn = drawing(tmp_path, 2, 6)
    left, right, rows = 64, 1000, (24, 70, 116, 162)
    sides = [f"M{x} {y}v46" for y in rows for x in (left, right)]
    assert sorted(drawn.lines.replace("M", " M").split(" M")[1:]) == sorted(
        line.removeprefix("M")
        for line in [
            *sides,
            # The sides of the flag.
            "M415 70v46",
            "M532 70v46",
            # The outline, and the boundaries of the second row.
            "M64 24H1000",
            "M64 70H532",
            "M64 116H1000",
            "M64 208H1000",
        ]
    )
    assert drawn.plan["rows"] == [0, 1, 2, 3]


def test_reserved_bits_are_hatched_within_their_box():
    assert hatch(10, 20, 30, 12) == ("M10 29L19 20M16 32L28 20M25 32L37 20M34 32L40 26")
    for x, y in re.findall(r"(\d+) (\d+)", hatch(64, 24, 234, 46)):
        assert 64 <= int(x) <= 64 + 234 and 24 <= int(y) <= 24 + 46


def test_an_empty_part_of_a_message_has_no_drawing(tmp_path):
    icd = loaded(tmp_path, status(length=2)).icd
    (node,) = icd.nodes
    assert draw_frame(node.messages[0], node, Links(icd), 1, 1) is None


def test_short_frames_of_small_fields_have_one_byte_in_a_row(tmp_path):
    def fields(bits: int) -> list:
        text = status(f"at: 0, bits: {bits}, name: Level, type: uint", length=60)
        return list(loaded(tmp_path, text).icd.nodes[0].messages[0].fields)

    assert_limits(lambda length: bytes_a_row(length, fields(7)) == 1, most=12)
    assert_limits(lambda length: bytes_a_row(length, fields(8)) == 2, least=2, most=48)
    assert bytes_a_row(49, fields(7)) == 4
    assert_limits(lambda bits: bytes_a_row(12, fields(bits)) == 1, most=7)

"""Drawing of the old and new bit layout: each rectangle and connection in pixels."""

from __future__ import annotations

import pytest

from icdgen.diff.pairs import MessagePair
from icdgen.diff.reports.drawing import (
    CELL,
    LEFT,
    NEW_Y,
    OLD_Y,
    BitRow,
    ComparedDrawing,
    FieldBox,
    FieldLink,
    _folded,
    _label,
    draw,
)
from tests.diff.cases import compared_texts
from tests.limits import assert_limits


def message(*fields: str, length: int) -> str:
    rows = "".join(f"      - {{{field}}}\n" for field in fields)
    return (
        "messages:\n  - name: Status\n    id: 130\n    kind: telemetry\n"
        f"    length: {length}\n    fields:\n{rows}"
    )


def drawn(folder, old: str, new: str) -> ComparedDrawing | None:
    comparison = compared_texts(folder, old, new, is_checked=False)
    ((pair,),) = (node.messages for node in comparison.match.nodes)
    assert isinstance(pair, MessagePair)
    return draw(pair, comparison.changes)


def boxes(row: BitRow, y: int) -> list[tuple]:
    """Return kind, label, first bit and bits of the boxes of one side."""
    return [
        (box.kind, box.label, (box.x - LEFT) / CELL, box.width / CELL)
        for box in row.boxes
        if box.y == y
    ]


LEVEL = "at: 0, bits: 8, name: Level, type: uint"
MODE = "at: 8, bits: 8, name: Mode, type: uint"


def test_a_moved_field_is_connected_with_its_new_place(tmp_path):
    drawing = drawn(
        tmp_path,
        message(LEVEL, MODE, length=2),
        message(
            LEVEL,
            "at: 8, bits: 8, name: Added, type: uint",
            "at: 16, bits: 8, name: Mode, type: uint",
            length=3,
        ),
    )
    assert drawing.title == "Bit layouts of Status, old above new"
    (row,) = drawing.parts
    assert boxes(row, OLD_Y) == [("same", "Level", 0, 8), ("moved", "Mode", 8, 8)]
    assert boxes(row, NEW_Y) == [
        ("same", "Level", 0, 8),
        ("come", "Added", 8, 8),
        ("moved", "Mode", 16, 8),
    ]
    mode = next(box for box in row.boxes if box.label == "Mode")
    assert row.links == [FieldLink("156,42 268,42 380,58 268,58", "moved", mode.key)]
    assert row.frames == [
        FieldBox(44, OLD_Y, 224, "frame", "", "reserved", ""),
        FieldBox(44, NEW_Y, 336, "frame", "", "reserved", ""),
    ]
    assert row.ticks == [(44 + 112 * byte, byte) for byte in range(8)]
    assert (drawing.width, drawing.height, drawing.old_y, drawing.new_y) == (
        941,
        94,
        29,
        71,
    )


@pytest.mark.parametrize(
    ("old", "new", "kind"),
    [
        (LEVEL, LEVEL.replace("uint", "int"), "wire"),
        (LEVEL, LEVEL.replace("bits: 8", "bits: 7"), "wire"),
        (LEVEL, f"{LEVEL}, formula: raw*2, unit: V", "meaning"),
        (LEVEL, LEVEL.replace("Level", "Fill Level"), "name"),
        (LEVEL, LEVEL.replace("at: 0", "at: 16"), "moved"),
    ],
)
def test_a_field_has_the_kind_of_its_most_severe_change(tmp_path, old, new, kind):
    drawing = drawn(
        tmp_path, message(old, MODE, length=3), message(new, MODE, length=3)
    )
    (row,) = drawing.parts
    assert [box.kind for box in row.boxes if "evel" in box.label] == [kind] * 2
    assert [link.kind for link in row.links] == [kind]


def test_layouts_that_differ_in_words_only_are_not_drawn(tmp_path):
    old = message(LEVEL, length=1)
    new = message(f"{LEVEL}, summary: How full it is.", length=1)
    assert drawn(tmp_path, old, new) is None
    # Another end of the frame is a difference of the layout.
    longer = drawn(tmp_path, old, message(LEVEL, length=2))
    assert [frame.width / CELL for frame in longer.parts[0].frames] == [8, 16]


def test_a_removed_field_has_no_box_below(tmp_path):
    drawing = drawn(tmp_path, message(LEVEL, MODE, length=2), message(LEVEL, length=2))
    (row,) = drawing.parts
    assert boxes(row, OLD_Y) == [("same", "Level", 0, 8), ("gone", "Mode", 8, 8)]
    assert boxes(row, NEW_Y) == [("same", "Level", 0, 8)]
    assert row.links == []


def test_a_title_has_place_type_formula_and_unit(tmp_path):
    field = f"{LEVEL}, formula: raw*0.5, unit: V"
    drawing = drawn(tmp_path, message(field, length=1), message(field, length=2))
    assert {box.title for box in drawing.parts[0].boxes} == {
        "Level, bits 0 to 7, 8-bit uint, raw*0.5, V"
    }


def test_a_field_in_two_rows_has_a_box_in_each(tmp_path):
    wide = "at: 56, bits: 16, name: Wide, type: uint"
    drawing = drawn(
        tmp_path,
        message(wide, length=9),
        message(wide.replace("uint", "int"), length=9),
    )
    first, second = drawing.parts
    for y in (OLD_Y, NEW_Y):
        assert boxes(first, y) == [("wire", "Wide", 56, 8)]
        assert boxes(second, y) == [("wire", "Wide", 0, 8)]
    assert [frame.width / CELL for frame in first.frames] == [64, 64]
    assert [frame.width / CELL for frame in second.frames] == [8, 8]
    assert second.ticks[0] == (44, 8)
    assert len(first.links) == len(second.links) == 1


def test_unchanged_rows_are_folded_if_there_are_several(tmp_path):
    many = [f"at: {64 * n}, bits: 8, name: F{n}, type: uint" for n in range(6)]
    changed = [*many[:3], many[3].replace("uint", "int"), *many[4:]]
    drawing = drawn(tmp_path, message(*many, length=48), message(*changed, length=48))
    assert [part if isinstance(part, str) else "row" for part in drawing.parts] == [
        "bytes 0 to 23 are as before",
        "row",
        "bytes 32 to 47 are as before",
    ]
    changed = [many[0].replace("uint", "int"), many[1], many[2].replace("uint", "int")]
    drawing = drawn(
        tmp_path, message(*many[:3], length=24), message(*changed, length=24)
    )
    assert all(isinstance(part, BitRow) for part in drawing.parts)
    assert _folded([BitRow(), BitRow()]) == ["bytes 0 to 15 are as before"]
    assert len(_folded([BitRow()])) == 1


def test_a_label_is_cut_to_its_box():
    # Of 8 bits, 112 - 4 pixels have room for 17 letters.
    assert _label("a" * 17, 112) == "a" * 17
    assert _label("a" * 18, 112) == "a" * 16 + "…"
    assert_limits(lambda width: _label("a" * 9, width) != "", least=29)
    assert _label("a" * 9, 29) == "aaa…"
    assert _label("abc", 23) == "abc"
    assert _label("abcd", 23) == ""


def test_an_added_or_removed_message_has_a_frame_on_one_side(tmp_path):
    text = message(LEVEL, length=1)
    other = text.replace("Status", "Blob").replace("130", "140").replace("Level", "Xy")
    comparison = compared_texts(tmp_path, text, other, is_checked=False)
    pairs = {pair.any.name: pair for pair in comparison.match.nodes[0].messages}
    for name, y, kind in (("Status", OLD_Y, "gone"), ("Blob", NEW_Y, "come")):
        drawing = draw(pairs[name], comparison.changes)
        (row,) = drawing.parts
        assert [(frame.y, frame.width / CELL) for frame in row.frames] == [(y, 8)]
        assert [(box.y, box.kind) for box in row.boxes] == [(y, kind)]
        assert row.links == []


@pytest.mark.parametrize(("length", "rows"), [(7, 1), (8, 1), (9, 2), (16, 2), (17, 3)])
def test_a_row_has_64_bits(tmp_path, length, rows):
    last = f"at: {8 * length - 8}, bits: 8, name: Last, type: uint"
    drawing = drawn(
        tmp_path,
        message(last, length=length),
        message(last.replace("uint", "int"), length=length),
    )
    count = sum(1 if isinstance(part, BitRow) else (rows - 1) for part in drawing.parts)
    assert count == rows

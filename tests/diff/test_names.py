"""The report shows names and types of generated code that change."""

from __future__ import annotations

import pytest

from icdgen.diff.changes.names import renamed_lines
from icdgen.diff.generated import Name
from icdgen.diff.reports.json import document
from tests.diff.cases import FOLDER, compared, compared_texts, rows_of

RENAMED_NODE = """\
icdgen: 1
node: {{name: {node}, title: Demo, byte_order: little, bit_order: lsb0}}
enums:
  - {{name: Mode, members: [{{value: 0, name: Idle}}]}}
structs:
  - {{name: Part, length: 1, fields: [{{at: 0, bits: 8, name: Mode, type: enum, enum: Mode}}]}}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 3
    fields:
      - {{at: 0, name: Part, struct: Part}}
      - {{at: 8, bits: 8, name: Mode, type: enum, enum: Mode}}
      - {{at: 16, bits: 8, name: Count, type: {type}}}
"""


def test_a_retyped_field_of_a_renamed_node_is_reported_without_the_types_that_only_have_a_new_prefix(
    tmp_path,
):
    old = RENAMED_NODE.format(node="demo", type="uint")
    new = RENAMED_NODE.format(node="probe", type="int")
    changes = compared_texts(tmp_path, old, new).changes
    retyped = [change.message for change in changes if change.code == "DIF307"]
    assert retyped == ["`Count` has another type in C and Rust"]


def test_functions_for_elements_and_contained_messages_are_names_of_their_message():
    changes = document(compared(FOLDER / "DIF127"))["changes"]
    names = next(
        change["generated"] for change in changes if change["code"] == "DIF127"
    )
    assert {
        "demo_satellites_read_satellites",
        "demo_satellites_write_satellites",
    } <= set(names["c"])
    assert {"read_satellites", "write_satellites"} <= set(names["rust"])


def name(language: str, text: str) -> Name:
    return Name(language, text)


def test_types_come_first_and_two_names_of_each_language_are_shown():
    a, b = (
        [name("c", text) for text in texts]
        for texts in (("a", "b", "x_t", "c"), "defg")
    )
    rust = [(name("rust", "A"), name("rust", "B"))] * 2
    pairs = [*rust, *zip(a, b, strict=True)]
    assert renamed_lines(pairs) == (
        "C: `x_t` -> `f`, `a` -> `d` and 2 more",
        "Rust: `A` -> `B`",
    )
    assert renamed_lines(pairs[2:5]) == ("C: `x_t` -> `f`, `a` -> `d` and 1 more",)
    assert renamed_lines(pairs[2:4]) == ("C: `a` -> `d` and `b` -> `e`",)


def test_names_are_listed_alone_if_all_are_new_or_all_are_gone():
    a, b = name("python", "a"), name("python", "b")
    assert renamed_lines([(None, a), (None, b)]) == ("Python: `a` and `b`",)
    assert renamed_lines([(a, None)]) == ("Python: `a`",)
    assert renamed_lines([(a, None), (None, b)]) == (
        "Python: `a` -> (gone) and (new) -> `b`",
    )
    assert renamed_lines([]) == ()


ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 1, name: Run}]}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 8, bits: 8, name: Bus Voltage, type: uint, unit: V}
"""


def swapped(*rows: tuple) -> list[tuple]:
    """Return the rows of the reverse comparison: names and places are exchanged."""
    return [(code, was, now, *places[::-1]) for code, now, was, *places in rows]


def code_and_values(folder, old: str, new: str) -> list[tuple]:
    rows = rows_of(compared_texts(folder, old, new, is_checked=False), *NAMES)
    return [(row[0], row[3], row[4], row[5], row[6]) for row in rows]


NAMES = "DIF301 DIF302 DIF303 DIF304 DIF305 DIF309 DIF312".split()


@pytest.mark.parametrize(
    ("old", "new", "rows"),
    [
        ("name: Status", "name: State", [("DIF301", "Status", "State", "Status", "State")]),
        ("name: Status", "name: Status, identifier: State".replace(", ", "\n    "),
         [("DIF301", "Status", "State", "Status", "Status")]),
        ("name: Bus Voltage", "name: Voltage of Bus",
         [("DIF302", "Bus Voltage", "Voltage of Bus", "Bus Voltage", "Voltage of Bus")]),
        ("name: Bus Voltage", "name: Bus voltage", []),
        ("name: Bus Voltage", "identifier: Volts, name: Bus Voltage",
         [("DIF302", "Bus Voltage", "Volts", "Bus Voltage", "Bus Voltage")]),
        ("name: Run", "name: Running", [("DIF304", "Run", "Running", "Run", "Running")]),
        ("name: demo", "name: probe", [("DIF305", "demo", "probe", "demo", "probe")]),
        ("type: uint, unit: V", "view: true, type: uint, unit: V",
         [("DIF312", "a field with bits of its own", "a view", "8", "true")]),
    ],
)  # fmt: skip
def test_another_name_is_reported_in_both_directions(tmp_path, old, new, rows):
    assert old in ICD
    other = ICD.replace(old, new, 1)
    assert code_and_values(tmp_path, ICD, other) == rows
    assert code_and_values(tmp_path, other, ICD) == swapped(*rows)


def test_another_node_name_counts_its_messages_and_enumerations(tmp_path):
    old = ICD + "  - {name: Rate, id: 131, kind: telemetry, length: 0}\n"
    new = old.replace("name: demo", "name: probe")
    (row,) = rows_of(compared_texts(tmp_path, old, new, is_checked=False), "DIF305")
    assert (
        row[2] == "node `probe` was called `demo`: every generated name of it changes"
    )
    assert row[7:] == ("It declares 2 messages and 1 enumeration.",)


def test_words_that_are_split_otherwise_are_reported_with_the_other_words(tmp_path):
    text = ICD.replace("name: Bus Voltage", "name: BUSVoltage")
    old, new = (
        text.replace("enums:", f"vocabulary: {words}\nenums:")
        for words in ("[Volt, BUSV]", "[Volt, BUSVolt]")
    )
    (row,) = rows_of(compared_texts(tmp_path, old, new, is_checked=False), "DIF309")
    assert row[3:5] == ("BUSV", "BUSVolt")
    # Renamed parts have rows of their own.
    renamed = new.replace("name: Run", "name: Running")
    (other,) = rows_of(
        compared_texts(tmp_path, old, renamed, is_checked=False), "DIF309"
    )
    assert other == row
    same = old.replace("[Volt, BUSV]", "[BUSV, Volt]")
    assert compared_texts(tmp_path, old, same, is_checked=False).changes == []

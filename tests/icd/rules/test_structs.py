"""Rules of structs: what uses them, what they contain, and where they can be."""

from __future__ import annotations

import tempfile
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.icd.files import codes
from tests.icd.rules.reported import messages, reported

NAMES = "ABCDE"
GRAPHS = st.lists(
    st.lists(st.sampled_from(NAMES), max_size=2, unique=True), min_size=3, max_size=5
)
"""Structs that each of `A`, `B` and so on contains."""


def struct(name: str, *fields: str, length: int = 4) -> str:
    rows = "".join(f"      - {{{field}}}\n" for field in fields)
    return f"  - name: {name}\n    length: {length}\n    fields:\n{rows}"


def status(*fields: str, length: int = 4, id: int = 1) -> str:
    rows = "".join(f"      - {{{field}}}\n" for field in fields)
    head = f"  - name: Status {id}\n    id: {id}\n    kind: telemetry\n"
    return f"{head}    length: {length}\n    fields:\n{rows}"


NUMBER = "at: 0, bits: 32, name: Number, type: uint"


def use(name: str, at: int = 0, keys: str = "") -> str:
    return f"at: {at}, name: Use of {name}, struct: {name}{keys}"


def distances(graph: list[list[str]]) -> dict[tuple[str, str], int]:
    """Return the least number of steps from each struct to each that it contains, by
    trying all intermediate ones.
    """
    steps = {
        (name, inner): 1
        for name, uses in zip(NAMES, graph, strict=False)
        for inner in uses
    }
    for _ in NAMES:
        for (first, middle), one in list(steps.items()):
            for (other, last), two in list(steps.items()):
                if middle == other and one + two < steps.get((first, last), 99):
                    steps[first, last] = one + two
    return steps


@settings(max_examples=60, deadline=None)
@given(GRAPHS)
def test_every_use_that_leads_back_to_its_struct_is_reported_with_the_shortest_way(
    graph,
):
    names = NAMES[: len(graph)]
    text = "structs:\n"
    expected = []
    steps = distances(graph)
    for name, uses in zip(names, graph, strict=True):
        text += struct(name, NUMBER, *(use(inner) for inner in uses))
        for inner in uses:
            length = 1 if inner == name else 1 + steps.get((inner, name), 99)
            if length < 99:
                expected.append((name, inner, length))
    with tempfile.TemporaryDirectory() as folder:
        found = messages(Path(folder), text, "ICD141")
    ways = [
        message.partition("contains itself: ")[2].split(" -> ") for message in found
    ]
    assert [(way[0], way[1], len(way) - 1) for way in ways] == expected
    for way in ways:
        assert way[0] == way[-1]
        assert all(steps.get(pair) == 1 for pair in pairwise(way))


@settings(max_examples=60, deadline=None)
@given(GRAPHS, st.sets(st.sampled_from(NAMES), max_size=2))
def test_structs_that_no_message_uses_are_reported(graph, used):
    """Neither an unused struct nor itself uses a struct."""
    names = NAMES[: len(graph)]
    used &= set(names)
    text = "structs:\n" + "".join(
        struct(name, NUMBER, *(use(inner) for inner in uses))
        for name, uses in zip(names, graph, strict=True)
    )
    text += "messages:\n" * bool(used) + "".join(
        status(use(name), id=id) for id, name in enumerate(sorted(used), 1)
    )
    steps = distances(graph)
    reached = {inner for (outer, inner) in steps if outer in used} | used
    with tempfile.TemporaryDirectory() as folder:
        found = messages(Path(folder), text, "ICD144")
    assert found == [
        f"no message uses the struct `{name}`" for name in names if name not in reached
    ]


def test_a_misspelt_struct_counts_as_used(tmp_path):
    text = "structs:\n" + struct("Point", NUMBER) + struct("Other", NUMBER)
    text += "messages:\n" + status(use("Pont"))
    assert codes(tmp_path, text) == ["ICD144", "ICD140"]
    assert messages(tmp_path, text, "ICD144") == ["no message uses the struct `Other`"]


def test_a_struct_of_an_included_file_is_used(tmp_path):
    base = (
        "# base.yaml\nicdgen: 1\n"
        "node: {name: base, title: Base, byte_order: little, bit_order: lsb0}\n"
        "structs:\n" + struct("Point", NUMBER)
    )
    text = "messages:\n" + status(use("Point"))
    assert codes(tmp_path, "include: [base.yaml]\n" + text + base) == []
    assert codes(tmp_path, text + base) == ["ICD144", "ICD140"]
    (found,) = reported(tmp_path, text + base, "ICD140")
    help = f"`base` declares it: include {tmp_path / 'base.yaml'}"
    assert found == (9, "Point", "there is no struct `Point`", help)


@pytest.mark.parametrize(
    ("at", "before", "behind"),
    [(8, None, None), (9, "8", "16"), (15, "8", "16"), (8001, "8,000", "8,008")],
)
def test_a_struct_begins_at_a_byte(at, before, behind, tmp_path):
    text = "structs:\n" + struct("Point", NUMBER)
    text += "messages:\n" + status(use("Point", at), length=1010)
    expected = (
        14,
        str(at),
        f"`Use of Point` is a struct, but bit {at:,} is not the beginning of a byte",
        f"structs begin at bits {before} and {behind}",
    )
    assert reported(tmp_path, text, "ICD142") == ([expected] if before else [])


def test_an_array_of_structs_begins_at_a_byte(tmp_path):
    text = "structs:\n" + struct("Point", NUMBER)
    text += "messages:\n" + status(use("Point", 4, ", count: 2"), length=9)
    assert [each[:2] for each in reported(tmp_path, text, "ICD142")] == [(14, "4")]


KEYS = {
    "identifier": "point",
    "count": "2",
    "summary": "A point.",
    "aliases": "[Spot]",
    "bits": "32",
    "type": "uint",
    "byte_order": "big",
    "bit_order": "msb0",
    "view": "true",
    "unit": "V",
    "formula": "raw*2",
    "const": "1",
    "min": "1",
    "display": "hex",
    "bitfields": "[]",
}


@pytest.mark.parametrize("key", KEYS)
def test_a_use_of_a_struct_has_keys_of_its_own(key, tmp_path):
    text = "structs:\n" + struct("Point", NUMBER)
    text += "messages:\n" + status(use("Point", keys=f", {key}: {KEYS[key]}"), length=8)
    expected = (
        f"`Use of Point` is a struct, which cannot have `{key}`; its fields can",
        "move it to the fields of the struct `Point`, or remove it",
    )
    found = [each[2:] for each in reported(tmp_path, text, "ICD143")]
    allowed = ("identifier", "count", "summary", "aliases")
    assert found == [expected] * (key not in allowed)


def test_a_struct_in_a_struct_has_no_keys_of_fields_either(tmp_path):
    keys = ", when: {Number: 1}, unit: V"
    text = "structs:\n" + struct("In", NUMBER) + struct("Out", NUMBER, use("In", 32, keys), length=8)  # fmt: skip
    assert [
        (each.line, each.message) for each in reported(tmp_path, text, "ICD143")
    ] == [
        (12, "`Use of In` is a struct, and optional structs are not supported"),
        (12, "`Use of In` is a struct, which cannot have `unit`; its fields can"),
    ]


def test_each_overlay_field_of_a_struct_is_reported(tmp_path):
    low = "at: 0, bits: 8, name: {}, type: uint, view: {}"
    text = "structs:\n" + struct("Point", NUMBER, low.format("Low", "true"), low.format("High", "true"))  # fmt: skip
    assert reported(tmp_path, text, "ICD143") == [
        (
            line,
            "true",
            f"`{name}` is an overlay field, which is not supported in a struct",
            "write the overlay field in the message",
        )
        for line, name in ((8, "Low"), (9, "High"))
    ]


SPLIT = "at: 0, bits: 32, name: Both, type: uint{}, bitfields: [{{at: 0, bits: 16, name: Low}}, {{at: 16, bits: 16, name: High}}]"


@pytest.mark.parametrize(
    ("of_split", "of_message", "is_reported"),
    [
        ("", "", False),
        ("", "    byte_order: little\n", False),
        ("", "    byte_order: big\n", True),
        ("", "    bit_order: msb0\n", True),
        (", byte_order: little", "    byte_order: big\n", True),
        (", bit_order: lsb0", "    bit_order: msb0\n", True),
        (", byte_order: little, bit_order: lsb0", "    byte_order: big\n", False),
    ],
)
def test_the_parts_of_a_split_field_stay_where_the_struct_declares_them(
    of_split, of_message, is_reported, tmp_path
):
    message = status(use("Point")).replace("    length", f"{of_message}    length")
    text = "structs:\n" + struct("Point", SPLIT.format(of_split))
    expected = (
        14 + (of_message != ""),
        "Point",
        "`Use of Point` has other orders than `demo`, so the bits of the split field "
        "`Both` (line 7) would be in other places",
        "give `Both` a `byte_order` and a `bit_order`, or make its parts fields",
    )
    found = reported(tmp_path, f"{text}messages:\n{message}", "ICD145")
    assert found == [expected] * is_reported


def test_a_split_field_without_a_name_is_reported_by_the_schema_only(tmp_path):
    message = status(use("Point")).replace(
        "    length", "    byte_order: big\n    length"
    )
    for old, new in (("name: Both, ", ""), ("name: Both", "name: [Both]")):
        text = "structs:\n" + struct(
            "Point", NUMBER, SPLIT.format("").replace(old, new)
        )
        assert set(codes(tmp_path, f"{text}messages:\n{message}")) == {"ICD010"}

"""``icdgen show`` prints messages of variable length, and its JSON reads back."""

from __future__ import annotations

import json

import jsonschema_rs

from icdgen.diff.inputs import shown
from icdgen.icd.places import places_in
from icdgen.loading import load
from icdgen.show.fields import field_table
from icdgen.show.machine import SCHEMA, to_json
from icdgen.show.people import to_text
from tests.conformance import odd


def read():
    loaded = load([odd.FOLDER / "open.yaml"])
    assert loaded.findings == []
    return loaded.icd


def test_a_variable_length_array_is_one_line_with_its_limit_and_counter():
    icd = read()
    node = icd.node("open")
    tables = {
        message.name: field_table(message, node).splitlines()[-1]
        for message in node.messages
    }
    assert (
        "up to 5 x 24" in tables["Narrow"]
        and "up to the end of the frame" in tables["Narrow"]
    )
    assert "as many as Levels Count says" in tables["Counted"]
    assert "up to 80 x 8" in tables["Text"]
    assert "Samples Count" not in "".join(tables.values())  # no frame contains it
    assert "4 to 28 bytes" in to_text(icd, ["open", "Counted"])


def test_what_is_shown_for_programs_is_read_back_with_the_open_ends():
    icd = read()
    tree = to_json(icd)
    jsonschema_rs.validator_for(
        json.loads(SCHEMA.read_text(encoding="utf-8"))
    ).validate(tree)
    read_back = shown.from_bytes(json.dumps(tree).encode(), "shown").icd
    assert list(map(_facts, read_back.nodes[0].messages)) == list(
        map(_facts, icd.nodes[0].messages)
    )


def test_fields_after_a_variable_length_array_are_shown_and_read_back():
    icd = load([odd.FOLDER / "behind.yaml"]).icd
    node = icd.node("behind")
    rows = {
        message.name: field_table(message, node).splitlines()
        for message in node.messages
    }
    assert "up to the fields behind it" in rows["Packet"][-2]
    assert "CRC" in rows["Packet"][-1] and "behind Payload" in rows["Packet"][-1]
    assert "Total" in rows["Between"][-1] and "behind Third" in rows["Between"][-1]
    assert "4 to 44 bytes" in to_text(icd, ["behind", "Packet"])
    tree = to_json(icd)
    jsonschema_rs.validator_for(
        json.loads(SCHEMA.read_text(encoding="utf-8"))
    ).validate(tree)
    read_back = shown.from_bytes(json.dumps(tree).encode(), "shown").icd
    for old, new in zip(node.messages, read_back.nodes[0].messages, strict=True):
        assert _facts(old) == _facts(new)
        assert [(place.name, place.at) for place in places_in(old.layout)] == [
            (place.name, place.at) for place in places_in(new.layout)
        ]


def test_arrays_in_elements_are_shown_with_their_counters_and_read_back():
    loaded = load([odd.FOLDER / "curves.yaml"])
    assert loaded.findings == []
    icd = loaded.icd
    table = field_table(icd.node("curves").messages[0], icd.node("curves"))
    assert "up to 4 of Points, as many as Points Count says" in " ".join(table.split())
    tree = to_json(icd)
    jsonschema_rs.validator_for(
        json.loads(SCHEMA.read_text(encoding="utf-8"))
    ).validate(tree)
    (curve,) = (
        struct for struct in tree["nodes"][0]["structs"] if struct["name"] == "Curve"
    )
    counted = {
        field["name"]: (field["counter"], field.get("plus", 0))
        for field in curve["fields"]
        if "counter" in field
    }
    assert counted == {"Points": ("Points Count", 0), "Levels": ("Last Level", 1)}
    read_back = shown.from_bytes(json.dumps(tree).encode(), "shown").icd
    for old, new in zip(
        icd.nodes[0].messages, read_back.nodes[0].messages, strict=True
    ):
        assert _facts(old) == _facts(new)
        assert _counted(old) == _counted(new)


def _counted(message):
    return [
        (part.name, part.counter, part.begin, part.step, part.most, part.plus)
        for part in message.layout.counted_parts
    ]


def _facts(message):
    parts = [
        (part.name, part.counter, part.begin, part.step, part.most, part.plus)
        for part in message.layout.parts
    ]
    return (
        message.name,
        message.length,
        message.layout.lengths,
        parts,
        [field.name for field in message.fields],
    )

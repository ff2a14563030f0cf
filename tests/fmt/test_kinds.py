"""Kinds of mappings: their names and the order of their keys come from the schema."""

from __future__ import annotations

import pytest

from icdgen.icd import schema
from icdgen.icd.fmt.kinds import BLOCKS, INLINE, ROWS, SchemaKind, kind_of_root


def at(
    *path: str | None, document: str = "icd", last_is_mapping: bool = True
) -> SchemaKind:
    """Return the kind at a path of keys; None stands for an item of a list."""
    kind = kind_of_root(document)
    for number, key in enumerate(path):
        is_last = number == len(path) - 1
        is_mapping = last_is_mapping if is_last else path[number + 1] is not None
        kind = kind.child(key, is_mapping)
    return kind


@pytest.mark.parametrize(
    ("path", "name"),
    [
        (["node"], "node"),
        (["messages", None], "message"),
        (["messages", None, "fields", None], "field"),
        (["messages", None, "derived", None], "derived"),
        (["enums", None], "enum"),
        (["enums", None, "members", None], "member"),
        (["units", None], "unit"),
        (["loggable", None], "loggable"),
        (["protocol"], "protocol"),
        (["protocol", "boot"], "section"),
        (["protocol", "link"], "section"),
        (["protocol", "link", "header", None], "packet_field"),
        (["messages", None, "source"], "source"),
        (["enums", None, "also", None], "source"),
        (["zz"], ""),
        (["zz", None, "node"], ""),
        (["messages", None, "zz"], ""),
    ],
)
def test_a_mapping_has_the_name_of_its_definition(path, name):
    assert at(*path).name == name


def test_errata_have_kinds_of_their_own():
    assert at("entries", None, document="errata").name == "erratum"
    assert at("notes", None, document="errata").name == "note"
    assert kind_of_root("errata").name == "errata"


def test_a_value_can_be_one_mapping_or_a_list_of_them():
    for path in (["entries", None, "where"], ["entries", None, "where", None]):
        assert at(*path, document="errata").name == "where"


def test_a_list_has_no_name_of_a_mapping():
    assert at("messages", last_is_mapping=False).name == ""
    assert at("messages", last_is_mapping=False).keys == {}
    assert at("protocol", "boot", last_is_mapping=False).name == ""


@pytest.mark.parametrize("name", ["icd", "errata", "message", "field", "node"])
def test_keys_are_in_the_order_of_the_schema(name):
    kind = SchemaKind(name, schema.definition(name))
    keys = [*schema.definition(name)["properties"]]
    assert [*kind.keys] == keys
    assert [*kind.keys.values()] == [*range(len(keys))]


def test_all_kinds_with_a_style_of_their_own_are_definitions():
    """The kind `section` is that of each mapping in the protocol section."""
    for name in (ROWS | BLOCKS | INLINE) - {"section"}:
        assert schema.definition(name)
    assert not (ROWS & BLOCKS or ROWS & INLINE or BLOCKS & INLINE)


def test_kinds_are_looked_up_once():
    kind = kind_of_root("icd")
    assert kind_of_root("icd") is kind
    assert kind.child("node", True) is kind.child("node", True)
    assert kind.child("node", True) is not kind.child("node", False)
    # All unknown keys have the same kind.
    assert kind.child("zz", True) is kind.child("yy", True)

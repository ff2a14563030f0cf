"""Places of keys, values and items of a tree."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.diagnostics import Place
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq, place_of, plain, unread, yaml_text


def mark(line: int, column: int) -> SimpleNamespace:
    return SimpleNamespace(name="demo.yaml", index=0, line=line, column=column)


@pytest.mark.parametrize(
    ("start", "end", "place"),
    [
        ((0, 0), (0, 4), Place("demo.yaml", 1, 1, 4)),
        ((2, 3), (2, 4), Place("demo.yaml", 3, 4, 1)),
        ((2, 3), (2, 3), Place("demo.yaml", 3, 4, 1)),
        ((2, 3), (4, 9), Place("demo.yaml", 3, 4, 1)),
    ],
)
def test_a_place_has_the_length_of_a_value_of_one_line(start, end, place):
    assert place_of((mark(*start), mark(*end))) == place
    assert place_of(place) is place


def mapping() -> Map:
    tree = Map(Place("demo.yaml", 1))
    tree["name"] = "A"
    tree.spots["name"] = Place("demo.yaml", 2, 1, 4), Place("demo.yaml", 2, 7)
    return tree


def test_an_absent_key_is_at_the_start_of_the_mapping():
    tree = mapping()
    assert tree.key_at("name") == Place("demo.yaml", 2, 1, 4)
    assert (tree.at("name"), tree.at("type")) == (Place("demo.yaml", 2, 7), tree.place)
    with pytest.raises(KeyError):
        tree.key_at("type")
    del tree["name"]
    assert tree.at("name") == Place("demo.yaml", 2, 7), "an erratum removed the key"


def test_a_fault_is_at_a_value_or_a_key_with_its_fix_there():
    tree = mapping()
    value, key = tree.at("name"), tree.key_at("name")
    for fault, place, fix in (
        (Fault.at(tree, "name", "m", "h", "B"), value, (value, "B")),
        (Fault.at(tree, "name", "m", "h"), value, None),
        (Fault.at_key(tree, "name", "m", "h", "title"), key, (key, "title")),
        (Fault.at_key(tree, "name", "m", "h"), key, None),
        (Fault.of_place(tree, key, "m", "h", "x"), key, (key, "x")),
    ):
        assert fault == (tree, place, "m", "h", fix, None)
        assert fault.finding("ICD001") == ("ICD001", "m", place, "h", "error", fix, None)  # fmt: skip
    related = (key, "first")
    fault = Fault.at(tree, "name", "m", "h", related=related)
    assert fault.finding("ICD002", "warning")[4:] == ("warning", None, related)


def test_items_of_a_sequence_have_their_places():
    rows = Seq(Place("demo.yaml", 4))
    rows += ["a", "b"]
    rows.spots += [Place("demo.yaml", 5), (mark(5, 2), mark(5, 3))]
    assert rows.place == Place("demo.yaml", 4)
    assert rows.item_at(1) == Place("demo.yaml", 6, 3)
    assert list(rows.placed()) == [("a", Place("demo.yaml", 5)), ("b", rows.item_at(1))]


def test_a_plain_copy_has_no_places_and_shares_nothing():
    tree, rows = mapping(), Seq(Place("demo.yaml"))
    rows.append(tree)
    copy = plain({"rows": rows, "n": 0, "none": None})
    assert copy == {"rows": [{"name": "A"}], "n": 0, "none": None}
    assert (type(copy["rows"]), type(copy["rows"][0])) == (list, dict)
    assert copy["rows"][0] is not tree


def test_objects_without_a_file_share_an_empty_mapping():
    assert unread() is unread() and unread() == {}
    assert unread().place == Place("")


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "(absent)"), (True, "true"), (False, "false"), (0, "0"), ("", ""), (1.5, "1.5"), ("No", "No")],
)  # fmt: skip
def test_scalars_are_written_as_in_yaml(value, text):
    assert yaml_text(value) == text

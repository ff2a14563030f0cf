"""Paths of pages and anchors of the site."""

from __future__ import annotations

import re
from zlib import crc32

import pytest

from icdgen.backends.html.links import Links, free_name, slug
from icdgen.loading import load
from tests.icd.files import HEAD, write
from tests.limits import assert_limits


@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("Estimated Roll Angle", "estimated_roll_angle"),
        *((name, f"{name.lower()}_") for name in ("Index", "Protocol", "CON", "nul")),
        *((name, f"{name}_") for name in ("com0", "com9", "lpt0", "lpt9", "prn", "aux")),
        *((name, name) for name in ("com10", "lpt", "conn", "indexes", "errata")),
    ],
)  # fmt: skip
def test_a_path_is_none_of_the_own_files_and_devices_of_windows(name, path):
    assert slug(name, ()) == path


def test_a_name_without_letters_is_its_checksum():
    assert slug("???", ()) == f"{crc32(b'???'):08x}"
    assert slug("!", ()) != slug("?", ())


def test_a_path_of_more_than_80_characters_is_shortened_with_a_checksum():
    assert_limits(lambda size: slug("a" * size, ()) == "a" * size, most=80)
    assert slug("a" * 81, ()) == "a" * 80 + f"_{crc32(b'a' * 81):08x}"
    assert slug("a" * 81, ()) != slug("a" * 82, ())


def test_a_taken_name_gets_the_next_free_number():
    taken: set[str] = set()
    names = [free_name(name, taken) for name in ("a", "a", "b", "a", "a-2")]
    assert names == ["a", "a-2", "b", "a-3", "a-2-2"]
    assert taken == set(names)


ICD = """\
enums:
  - {name: Mode, members: [{value: 0, name: On}, {value: -1, name: on}, {value: 2, name: Off, identifier: Idle}]}
  - {name: mode, members: [{value: 0, name: On}]}
messages:
  - {name: Mode, id: 1, kind: telemetry, length: 2, fields: [
      {at: 0, bits: 4, name: Level A, type: uint}, {at: 4, bits: 4, name: Level-a, type: uint},
      {at: 8, bits: 8, name: Heat, identifier: Warmth, type: uint, unit: C}]}
  - {name: mode, id: 2, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Level A, type: uint}]}
  - {name: Enum, identifier: Index, id: 3, kind: telecommand, length: 0}
"""


def test_equal_names_of_one_owner_are_numbered(tmp_path):
    """Messages and enumerations do not share a path, nor fields of different owners."""
    icd = load([write(tmp_path, HEAD + ICD)], check=False).icd
    (node,) = icd.nodes
    links = Links(icd)
    first, second, _ = node.messages
    assert [links.message(message) for message in node.messages] == [
        "demo/mode.html",
        "demo/mode-2.html",
        "demo/index_.html",
    ]
    assert [links.enum(enum) for enum in node.enums] == [
        "demo/enum-mode.html",
        "demo/enum-mode-2.html",
    ]
    assert [links.field(first, field) for field in first.fields] == [
        "demo/mode.html#field-level_a",
        "demo/mode.html#field-level_a-2",
        "demo/mode.html#field-warmth",
    ]
    assert links.anchor(second, "Level A") == "field-level_a"
    mode, other = node.enums
    assert [links.anchor(mode, str(value)) for value in (0, -1, 2)] == [
        "member-on",
        "member-on-2",
        "member-idle",
    ]
    assert links.anchor(other, "0") == "member-on"
    assert links.unit(first.fields[2].unit) == "units.html#unit-c"
    assert (links.node("x"), links.printed("x"), links.protocol("x")) == (
        "x/index.html",
        "x/all-messages.html",
        "x/protocol.html",
    )


def test_no_path_of_a_message_is_that_of_another_page():
    for name in ("Enum-mode", "All messages", "all-messages", "index", "protocol"):
        path = slug(name, ())
        assert re.fullmatch("[a-z0-9_]+", path)
        assert path not in ("index", "protocol", "all-messages")

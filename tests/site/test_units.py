"""Values of the page of units and types."""

from __future__ import annotations

import pytest

from icdgen.backends.html import units
from icdgen.backends.html.relations import Relations
from icdgen.loading import load
from tests.icd.files import loaded, status
from tests.limits import assert_limits

SECOND = """\
# second.yaml
icdgen: 1
node: {name: second, title: Second, byte_order: big, bit_order: msb0}
messages:
  - {name: Heat, id: 1, kind: telemetry, length: 3, fields: [
      {at: 0, bits: 8, name: A, type: uint, unit: C},
      {at: 8, bits: 8, name: B, type: uint, unit: s},
      {at: 16, bits: 8, name: C, type: int, unit: min}]}
"""
FIELDS = (
    "at: 0, bits: 8, name: Count, type: uint, unit: V",
    "at: 8, bits: 16, name: Levels, type: uint, count: 3, unit: C",
    "at: 56, bits: 1, name: Flag, type: bool",
    "at: 64, bits: 32, name: Rate, type: float",
    "at: 96, bits: 24, name: Label, type: text",
)


@pytest.mark.parametrize("more", ["", SECOND])
def test_types_have_their_numbers_of_fields_and_units_their_quantity(tmp_path, more):
    result = loaded(tmp_path, status(*FIELDS, length=15) + more)
    assert result.ok, [finding.message for finding in result.findings]
    values = units.values(Relations(result.icd))
    rows = {name: (uses, widths) for name, _, uses, widths in values["types"]}
    assert rows == {
        "uint": (6 if more else 4, "8, 16"),
        "int": (1, "8") if more else (0, ""),
        "bool": (1, "1"),
        "enum": (0, ""),
        "float": (1, "32"),
        "bytes": (0, ""),
        "text": (1, "24"),
    }
    symbols = [
        (quantity, [entry["unit"].symbol for entry in entries])
        for quantity, entries in values["quantities"]
    ]
    # Quantities are in alphabetical order, units in the order of their first field.
    heat = ("temperature (degrees Celsius)", ["C"])
    times = [("time", ["s", "min"])] if more else []
    assert symbols == [heat, *times, ("voltage", ["V"])]
    numberings = {
        ("Demo", "little-endian", "lsb0"),
        ("Second", "big-endian", "msb0"),
    }
    alone = {("all nodes", "little-endian", "lsb0")}
    assert set(values["numberings"]) == (numberings if more else alone)


def test_nodes_of_the_same_orders_share_an_entry(tmp_path):
    for name, order in (("a", "little"), ("b", "big"), ("c", "little")):
        (tmp_path / f"{name}.yaml").write_text(
            f"icdgen: 1\nnode: {{name: {name}, title: {name.upper()}, byte_order: {order},"
            " bit_order: lsb0}\nmessages: []\n"
        )
    relations = Relations(load([tmp_path]).icd)
    assert units.values(relations)["numberings"] == [
        ("A, C", "little-endian", "lsb0"),
        ("B", "big-endian", "lsb0"),
    ]


def test_eight_fields_of_a_unit_are_shown(tmp_path):
    def is_complete(count: int) -> bool:
        fields = (
            f"at: {8 * index}, bits: 8, name: Level {index}, type: uint, unit: V"
            for index in range(count)
        )
        icd = loaded(tmp_path, status(*fields, length=count)).icd
        ((_, (entry,)),) = units.values(Relations(icd))["quantities"]
        assert [place.text for place in (*entry["uses"], *entry["more"])] == [
            f"Status: Level {index}" for index in range(count)
        ]
        return not entry["more"]

    assert_limits(is_complete, most=8)

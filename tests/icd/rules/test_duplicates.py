"""Names that must be unique within one file: fields of arrays and structs, members,
aliases, nodes and units.
"""

from __future__ import annotations

import pytest

from icdgen.icd.rules import duplicates  # noqa: F401
from tests.icd.files import status
from tests.icd.rules.rows import messages, rows

PAIR = """\
structs:
  - name: Pair
    length: 2
    fields: [{at: 0, bits: 8, name: A, type: uint}, {at: 8, bits: 8, name: B, type: uint}]
"""


def uint(at: int, name: str, more: str = "") -> str:
    return f"at: {at}, bits: 8, name: {name}, type: uint{more}"


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        (
            [uint(0, "V"), uint(8, "W"), uint(16, "V"), uint(24, "W"), uint(32, "V")],
            ["15:33 V line 13", "16:33 W line 14", "17:33 V line 13"],
        ),
        # A name can be that of an element of an array, or of a field of a struct.
        ([uint(0, "L", ", count: 2"), uint(16, "'L[1]'")], ["14:33 L[1] line 13"]),
        ([uint(0, "L", ", count: 2"), uint(16, "'L[2]'")], []),
        (
            [
                uint(0, "L", ", count: 2"),
                uint(16, "'L[1]'"),
                uint(24, "V"),
                uint(32, "V"),
            ],
            ["14:33 L[1] line 13", "16:33 V line 15"],
        ),
        (["at: 0, name: P, struct: Pair", uint(16, "P.B")], ["14:33 P.B line 6"]),
        (["at: 0, name: P, struct: Pair", uint(16, "P.C")], []),
        # Two arrays or structs of one name are one fault, not one for each element.
        (
            [uint(0, "L", ", count: 3"), uint(24, "L", ", count: 3")],
            ["14:33 L[0] line 13"],
        ),
        (
            [
                uint(0, "L", ", count: 2"),
                uint(16, "L", ", count: 2"),
                uint(32, "'M[0]'"),
            ],
            ["14:33 L[0] line 13"],
        ),
    ],
)
def test_names_of_fields_are_compared_with_those_of_elements(
    tmp_path, fields, expected
):
    text = PAIR + status(*fields, length=6)
    reported = [
        row.replace("`Status` already has a field ", "")
        .replace("`", "")
        .replace(", in", "")
        for row in rows(tmp_path, text, "ICD051")
    ]
    assert reported == expected


def test_fields_of_a_struct_are_compared_with_each_other(tmp_path):
    text = PAIR.replace("name: B", "name: A") + status(
        "at: 0, name: P, struct: Pair", "at: 16, name: Q, struct: Pair", length=4
    )
    assert rows(tmp_path, text, "ICD051") == [
        "6:76 `Pair` already has a field `A`, in line 6"
    ]


def enum(*members: str) -> str:
    rows = "".join(f"      - {{{member}}}\n" for member in members)
    return f"enums:\n  - name: Mode\n    members:\n{rows}"


def test_a_range_shares_values_with_members_inside(tmp_path):
    text = enum(
        "value: 8, to: 15, name: Low",
        "value: 20, name: One",
        "value: 15, name: Last",
        "value: 16, name: Next",
        "value: 17, to: 20, name: High",
    )
    assert rows(tmp_path, text, "ICD053") == [
        "8:17 `Low` (line 6) already has the value 15",
        "10:17 `One` (line 7) already has the value 20",
    ]


def test_of_ranges_with_one_end_the_longest_is_named(tmp_path):
    text = enum(
        "value: 3, to: 5, name: Short",
        "value: 1, to: 5, name: Long",
        "value: 5, name: End",
    )
    assert rows(tmp_path, text, "ICD053") == [
        "7:17 `Short` (line 6) already has the value 3",
        "8:17 `Long` (line 7) already has the value 5",
    ]


@pytest.mark.parametrize(
    ("first", "second", "is_wrong"),
    [
        ("name: Off", "name: Off", True),
        ("name: Off, identifier: Off 1", "name: Off, identifier: Off 1", True),
        ("name: Off, identifier: Off 1", "name: Off, identifier: Off 2", False),
        ("name: Off", "name: Off, identifier: Off 2", False),
        ("name: Off", "name: off", False),
    ],
)
def test_members_of_one_name_have_different_identifiers(
    tmp_path, first, second, is_wrong
):
    text = enum(f"value: 0, {first}", f"value: 1, {second}")
    assert messages(tmp_path, text, "ICD054") == (
        ["`Off` is already the name of 0 (line 6)"] if is_wrong else []
    )


@pytest.mark.parametrize(
    ("alias", "text"),
    [
        ("power status", "also the name of `Power Status`, in line 8"),
        ("POWER-STATUS", "also the name of `Power Status`, in line 8"),
        ("PowerStatus", "also the name of `Power Status`, in line 8"),
        ("Power Stat", ""),
        ("Supply", "also the name of `Power Status`, in line 8"),  # its identifier
        ("Volts", "also an alias of `Power Status`, in line 8"),
        ("HK", "its own name"),  # its identifier
        ("Beacon", "listed twice"),
        ("°", "also an alias of `Power Status`, in line 8"),
        ("Mode", ""),  # an enumeration
        ("Voltage", ""),  # a field
    ],
)
def test_an_alias_of_a_message_belongs_to_it_alone(tmp_path, alias, text):
    icd = f"""\
enums:
  - {{name: Mode, members: [{{value: 0, name: Idle}}]}}
structs:
  - {{name: Pair, length: 1, fields: [{{at: 0, bits: 8, name: A, type: uint}}]}}
messages:
  - {{name: Power Status, identifier: supply, aliases: [volts, "°"], id: 131, kind: telemetry, length: 0}}
  - name: Housekeeping
    identifier: hk
    aliases: [Beacon, "{alias}"]
    id: 130
    kind: telemetry
    length: 1
    fields: [{{at: 0, bits: 8, name: Voltage, type: uint}}]
"""
    expected = (
        [f"11:23 the alias `{alias}` of `Housekeeping` is {text}"] if text else []
    )
    assert rows(tmp_path, icd, "ICD074") == expected


def test_structs_and_enumerations_share_their_aliases(tmp_path):
    text = """\
enums:
  - {name: Mode, aliases: [pair], members: [{value: 0, name: Idle}]}
  - {name: Phase, aliases: [Both], members: [{value: 0, name: Idle}]}
structs:
  - {name: Pair, aliases: [both], length: 1, fields: [{at: 0, bits: 8, name: A, type: uint}]}
"""
    assert rows(tmp_path, text, "ICD074") == [
        "4:28 the alias `pair` of `Mode` is also the name of `Pair`, in line 7",
        "7:28 the alias `both` of `Pair` is also an alias of `Phase`, in line 5",
    ]


def test_aliases_of_members_and_fields_are_compared_within_their_owner(tmp_path):
    text = """\
enums:
  - name: Mode
    members: [{value: 0, name: Idle, aliases: [Sleep, busy]}, {value: 1, name: Busy, aliases: [sleep]}]
  - name: Phase
    members: [{value: 0, name: Day, aliases: [Sleep]}]
""" + status(uint(0, "A", ", aliases: [C]"), uint(8, "B", ", aliases: [c, Sleep]"))
    assert rows(tmp_path, text, "ICD074") == [
        "5:55 the alias `busy` of `Idle` is also the name of `Busy`, in line 5",
        "5:96 the alias `sleep` of `Busy` is also an alias of `Idle`, in line 5",
        "15:57 the alias `c` of `B` is also an alias of `A`, in line 14",
    ]


def test_aliases_of_an_included_file_are_reported_once(tmp_path):
    head = "icdgen: 1\nnode: {{name: {0}, title: {0}, byte_order: little, bit_order: lsb0}}\n"
    item = "{{name: {}, aliases: [{}], id: {}, kind: telecommand, length: 0}}"
    base = f"{head.format('base')}messages:\n  - {item.format('A', 'Go', 1)}\n"
    base += f"  - {item.format('B', 'go', 2)}\n"
    text = f"include: [base.yaml]\nmessages:\n  - {item.format('C', 'GO', 3)}\n# base.yaml\n{base}"
    text = text.replace("{{", "{").replace("}}", "}")
    assert rows(tmp_path, text, "ICD074") == [
        "base.yaml:5:25 the alias `go` of `B` is also an alias of `A`, in line 4",
        "5:25 the alias `GO` of `C` is also an alias of `A`, in base.yaml:4",
    ]


def test_a_node_is_compared_with_the_first_file_of_its_name(tmp_path):
    head = "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\n"
    text = f"# one.yaml\n{head}# two.yaml\n{head.replace('name: demo', 'name: two')}# three.yaml\n{head}"
    assert rows(tmp_path, text, "ICD057") == [
        "one.yaml:2:14 another file has declared the node `demo`: demo.yaml",
        "three.yaml:2:14 another file has declared the node `demo`: demo.yaml",
    ]


def test_each_declaration_of_a_unit_is_compared_with_the_first_and_the_built_in(
    tmp_path,
):
    unit = "  - {{symbol: {}, identifier: {}, quantity: time}}\n"
    symbols = [("tick", "a"), ("tick", "b"), ("Hz", "c"), ("tick", "d"), ("hz", "e")]
    text = "units:\n" + "".join(unit.format(*each) for each in symbols)
    assert rows(tmp_path, text, "ICD058") == [
        "5:14 the unit `tick` is already declared, in line 4",
        "6:14 the unit `Hz` is built in: frequency",
        "7:14 the unit `tick` is already declared, in line 4",
    ]

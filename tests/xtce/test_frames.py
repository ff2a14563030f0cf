"""A message becomes a container of XTCE with exactly the entries, positions, conditions
and notes that it needs.
"""

from __future__ import annotations

import pytest

from icdgen.backends.xtce.frames import BaseContainer, ContainerBuilder
from icdgen.backends.xtce.places import BitRun
from icdgen.backends.xtce.types import GeneratedType, TypeBuilder
from icdgen.describe import describe
from icdgen.icd.model import TELECOMMAND, TELEMETRY
from tests.icd.files import loaded

HEAD = 8  # bits of the header of all messages below
MSB = "mostSignificantByteFirst"


def built(folder, text, direction=TELEMETRY, shared=None):
    """Return the builder of a direction, and the frames of all messages of ``text``."""
    result = loaded(folder, text)
    assert result.ok, [finding.message for finding in result.findings]
    (node,) = describe(result.icd).nodes
    builder = ContainerBuilder(direction, TypeBuilder(), HEAD, shared or {}, set())
    return builder, [builder.frame(message) for message in node.messages]


def message(*fields, length, kind=TELEMETRY, name="Status", id=1, more=""):
    rows = "".join(f"      - {{{field}}}\n" for field in fields)
    return (
        f"  - name: {name}\n    id: {id}\n    kind: {kind}\n    length: {length}\n"
        f"{more}" + (f"    fields:\n{rows}" if fields else "")
    )


def reserved(size):
    """Return the key of bytes at the end of a message that no field has."""
    return f"    reserved: {size}\n"


def frame_of(folder, *fields, length, kind=TELEMETRY, before="", more=""):
    """Return the builder and the frame of a message with these fields."""
    text = (
        before + "messages:\n" + message(*fields, length=length, kind=kind, more=more)
    )
    builder, (frame,) = built(folder, text, kind)
    return builder, frame


def rows(frame):
    """Return name, start and bits in the frame, and fixed value of each entry."""
    return [(e.name, e.run.at, e.run.bits, e.value) for e in frame.entries]


def positions(frame):
    return [(e.name, e.at) for e in frame.entries]


def two(kind):
    """Return two messages with the same fields."""
    fields = (
        "at: 0, bits: 8, name: Mode, type: uint",
        "at: 8, bits: 8, name: Fan Speed, type: uint",
    )
    first = message(*fields, length=2, kind=kind, name="Set It")
    return (
        "messages:\n" + first + message(*fields, length=2, kind=kind, name="Set", id=2)
    )


def test_names_of_parameters_are_unique_and_those_of_arguments_in_their_command(
    tmp_path,
):
    _, frames = built(tmp_path, two(TELEMETRY))
    assert [(f.name, list(f.names.values())) for f in frames] == [
        ("SetIt", ["SetIt_Mode", "SetIt_FanSpeed"]),
        ("Set", ["Set_Mode", "Set_FanSpeed"]),
    ]
    _, frames = built(tmp_path, two(TELECOMMAND), TELECOMMAND)
    assert [(f.name, list(f.names.values())) for f in frames] == [
        ("SetIt", ["Mode", "FanSpeed"]),
        ("Set", ["Mode", "FanSpeed"]),
    ]


def test_a_used_name_of_a_container_and_of_a_parameter_gets_a_number(tmp_path):
    result = loaded(tmp_path, two(TELEMETRY))
    (node,) = describe(result.icd).nodes
    taken = {"SetIt", "SetIt_2_Mode"}
    builder = ContainerBuilder(TELEMETRY, TypeBuilder(), HEAD, {}, taken)
    frame = builder.frame(node.messages[0])
    assert frame.name == "SetIt_2"
    assert list(frame.names.values()) == ["SetIt_2_Mode_2", "SetIt_2_FanSpeed"]


def test_a_parameter_has_name_summary_and_meanings_of_its_field(tmp_path):
    _, frame = frame_of(
        tmp_path,
        "at: 0, bits: 8, name: Fan Speed, type: uint, summary: Of both fans.,"
        " special: [{value: 255, meaning: broken}]",
        "at: 8, bits: 8, name: Mark, type: uint, const: 7",
        "at: 8, bits: 4, name: Low, type: uint, view: true",
        length=2,
    )
    speed, mark, low = frame.rows
    assert speed[:4] == ("Status_FanSpeed", "uint8", "Fan Speed", "Of both fans.")
    assert [(s.value, s.meaning) for s in speed.special] == [(255, "broken")]
    assert speed[5:] == (None, False, False, 0)
    assert mark == ("Status_Mark", "uint8", "Mark", "", (), 7, False, False, 0)
    assert low == ("Status_Low", "uint4", "Low", "", (), None, False, True, 0)


@pytest.mark.parametrize(
    ("bits", "expected"),
    [
        (8, GeneratedType("Integer", 8, "unsigned")),
        (16, GeneratedType("Integer", 16, "unsigned", MSB)),
        (64, GeneratedType("Integer", 64, "unsigned", MSB)),
        (72, GeneratedType("Binary", 72)),
    ],
)
def test_reserved_bits_of_telemetry_are_a_number_of_at_most_64_bits(
    tmp_path, bits, expected
):
    builder, frame = frame_of(
        tmp_path,
        "at: 0, bits: 8, name: A, type: uint",
        length=1 + bits // 8,
        more=reserved(bits // 8),
    )
    assert rows(frame)[1:] == [(f"Reserved{bits}", HEAD + 8, bits, None)]
    (row,) = builder.reserved.values()
    assert row.is_reserved
    named = {name: type_ for type_, name in builder.types.names.items()}
    assert named[row.type] == expected
    assert row.type == (f"uint{bits}" if bits <= 64 else f"bytes{bits // 8}")


def test_reserved_bits_of_one_size_are_one_parameter_and_follow_each_other(tmp_path):
    builder, frame = frame_of(
        tmp_path,
        "at: 8, bits: 8, name: A, type: uint",
        "at: 24, bits: 8, name: B, type: uint",
        length=6,
        more=reserved(2),
    )
    assert rows(frame) == [
        ("Reserved8", 8, 8, None),
        ("Status_A", 16, 8, None),
        ("Reserved8", 24, 8, None),
        ("Status_B", 32, 8, None),
        ("Reserved16", 40, 16, None),
    ]
    assert list(builder.reserved) == ["Reserved8", "Reserved16"]
    assert {entry.at for entry in frame.entries} == {None}
    assert (frame.size, frame.lacks, frame.notes) == (0, [], [])


def test_reserved_bits_of_a_telecommand_are_zeros(tmp_path):
    builder, frame = frame_of(
        tmp_path,
        "at: 16, bits: 8, name: A, type: uint",
        length=4,
        kind=TELECOMMAND,
        more=reserved(1),
    )
    assert rows(frame) == [("", 8, 16, "0000"), ("A", 24, 8, None), ("", 32, 8, "00")]
    assert builder.reserved == {}


def test_a_message_without_fields_has_only_reserved_bits(tmp_path):
    _, frame = frame_of(tmp_path, length=2, more=reserved(2))
    assert rows(frame) == [("Reserved16", 8, 16, None)]
    _, frame = frame_of(tmp_path, length=0)
    assert rows(frame) == []


def test_bits_that_consumers_cannot_count_have_positions_in_the_container(tmp_path):
    _, frame = frame_of(
        tmp_path,
        "at: 16, bits: 8, name: B, type: uint",
        "at: 0, bits: 12, name: A, type: uint",
        length=5,
        more=reserved(2),
    )
    # Little endian, 12 bits: the reserved bits begin behind all fields.
    assert [entry.run.is_little for entry in frame.entries] == [False, True, False]
    assert sorted(positions(frame), key=lambda row: row[1]) == [
        ("Status_A", 8),
        ("Status_B", 24),
        ("Reserved16", 32),
    ]
    assert frame.size == 0


def test_reserved_bits_after_a_part_of_a_byte_begin_at_the_next_byte(tmp_path):
    _, frame = frame_of(
        tmp_path, "at: 0, bits: 12, name: A, type: uint", length=3, more=reserved(1)
    )  # fmt: skip
    assert positions(frame) == [("Status_A", 8), ("Reserved8", 24)]


OPTIONAL = (
    "at: 0, bits: 8, name: Kind, type: uint",
    "at: 8, bits: 8, name: Late, type: uint, when: {Kind: [3, 5], Mark: 9}",
    "at: 16, bits: 8, name: Mark, type: uint",
)


def test_an_optional_entry_states_its_conditions_and_follows_the_others(tmp_path):
    _, frame = frame_of(tmp_path, *OPTIONAL, length=4, more=reserved(1))
    assert positions(frame) == [
        ("Status_Kind", 8),
        ("Status_Mark", 24),
        ("Reserved8", 32),
        ("Status_Late", 16),
    ]
    assert [entry.needs for entry in frame.entries] == [
        (),
        (),
        (),
        (("Status_Kind", (3, 5)), ("Status_Mark", (9,))),
    ]
    assert frame.size == HEAD + 32


def test_a_constant_of_a_condition_is_an_argument_and_other_constants_are_fixed(
    tmp_path,
):
    _, frame = frame_of(
        tmp_path,
        "at: 0, bits: 8, name: Kind, type: uint, const: 3",
        "at: 8, bits: 8, name: Mark, type: uint, const: 9",
        "at: 16, bits: 8, name: Late, type: uint, const: 0xAB, when: {Kind: 3}",
        length=3,
        kind=TELECOMMAND,
    )
    assert rows(frame) == [
        ("Kind", 8, 8, None),
        ("Mark", 16, 8, "09"),
        ("Late", 24, 8, "AB"),
    ]
    assert frame.entries[2].needs == (("Kind", (3,)),)
    assert [(row.name, row.constant) for row in frame.rows] == [("Kind", 3)]


def test_telecommands_have_no_overlays(tmp_path):
    fields = (
        "at: 0, bits: 8, name: A, type: uint",
        "at: 0, bits: 4, name: Low, type: uint, view: true",
    )
    _, frame = frame_of(tmp_path, *fields, length=1)
    assert positions(frame) == [("Status_A", 8), ("Status_Low", 12)]
    _, frame = frame_of(tmp_path, *fields, length=1, kind=TELECOMMAND)
    assert positions(frame) == [("A", 8)]


# The bits of a field of 12 bits, in this order of bytes and bits, are not consecutive.
UNORDERED = "at: 4, bits: 12, name: Odd, type: uint, byte_order: big"


def test_a_field_with_an_order_that_xtce_lacks_is_left_out_with_its_overlays(tmp_path):
    _, frame = frame_of(
        tmp_path,
        UNORDERED,
        "at: 16, bits: 8, name: A, type: uint",
        "at: 16, bits: 4, name: Low, type: uint, view: true",
        length=4,
        more=reserved(1),
    )
    assert frame.lacks == [
        "`Odd` is left out: XTCE has no word for the order of its bits"
    ]
    # With positions, because the omitted bits are no reserved ones.
    assert positions(frame) == [("Status_A", 24), ("Reserved8", 32)]


def test_an_array_is_one_entry_and_another_has_an_entry_for_each_element(tmp_path):
    builder, frame = frame_of(
        tmp_path,
        "at: 0, bits: 16, name: A, type: uint, count: 3",
        "at: 48, bits: 12, name: B, type: uint, count: 2",
        "at: 72, bits: 8, name: C, type: uint, count: 2, const: 4",
        length=11,
    )
    assert [(e.name, e.run.at, e.run.bits, e.is_array) for e in frame.entries] == [
        ("Status_A", 8, 48, True),
        ("Status_B0", 56, 12, False),
        ("Status_B1", 68, 12, False),
        ("Status_C0", 80, 8, False),
        ("Status_C1", 88, 8, False),
    ]
    named = {name: type_ for type_, name in builder.types.names.items()}
    assert named["Status_A_Array"].count == 3


STRUCT = """\
structs:
  - name: View
    length: 2
    fields:
      - {at: 0, bits: 8, name: Azimuth, type: uint}
      - {at: 8, bits: 8, name: Height, type: int}
"""


def test_fields_of_structs_are_entries_of_the_message(tmp_path):
    _, frame = frame_of(
        tmp_path,
        "at: 0, name: In View, struct: View, count: 2",
        length=4,
        before=STRUCT,
    )
    assert rows(frame) == [
        ("Status_InView0Azimuth", 8, 8, None),
        ("Status_InView0Height", 16, 8, None),
        ("Status_InView1Azimuth", 24, 8, None),
        ("Status_InView1Height", 32, 8, None),
    ]
    assert [row.alias for row in frame.rows] == [
        "In View[0].Azimuth",
        "In View[0].Height",
        "In View[1].Azimuth",
        "In View[1].Height",
    ]


COUNTED = "at: 0, bits: 8, name: Size, type: uint"


@pytest.mark.parametrize(
    ("field", "kind", "is_array", "bits"),
    [
        ("name: Data, type: bytes, size: Size, up_to: 9", "Binary", False, 0),
        ("name: Data, type: text, size: Size, up_to: 9", "String", False, 0),
        ("bits: 16, name: Data, type: int, count: Size, up_to: 9", "Array", True, 0),
    ],
)
def test_a_counted_field_is_the_last_entry_with_its_maximum(
    tmp_path, field, kind, is_array, bits
):
    builder, frame = frame_of(tmp_path, COUNTED, f"at: 8, {field}", length=1)
    assert [(e.name, e.at, e.is_array) for e in frame.entries] == [
        ("Status_Size", None, False),
        ("Status_Data", None, is_array),
    ]
    assert frame.entries[1].run.at == HEAD + 8
    assert (frame.lacks, frame.rows[1].most) == ([], 9)
    named = {name: type_ for type_, name in builder.types.names.items()}
    type_ = named[frame.rows[1].type]
    assert (type_.kind, type_.bits, type_.count) == (kind, bits, 9)
    assert (type_.counter, type_.plus) == ("Status_Size", 0)
    assert frame.rows[1].type == ("Status_Data_Array" if is_array else "Status_Data")


def test_a_counted_field_behind_entries_with_positions_has_one(tmp_path):
    _, frame = frame_of(
        tmp_path,
        COUNTED,
        "at: 0, bits: 4, name: Low, type: uint, view: true",
        "at: 8, name: Data, type: bytes, size: Size, up_to: 9",
        length=1,
    )
    assert positions(frame) == [
        ("Status_Size", 8),
        ("Status_Low", 12),
        ("Status_Data", 16),
    ]


@pytest.mark.parametrize(
    ("fields", "before", "lacks"),
    [
        (  # no counter
            ["at: 0, name: Data, type: bytes, size: rest, up_to: 9"],
            "",
            [("Data", "size")],
        ),
        (  # structs
            [COUNTED, "at: 8, name: Data, struct: View, count: Size, up_to: 9"],
            STRUCT,
            [("Data", "size")],
        ),
        (  # a constant
            [
                COUNTED,
                "at: 8, bits: 8, name: Data, type: uint, count: Size, up_to: 9, const: 2",
            ],
            "",
            [("Data", "size")],
        ),
        (  # a field behind it
            [
                COUNTED,
                "at: 8, name: Data, type: bytes, size: Size, up_to: 9",
                "at: 8, after: Data, bits: 8, name: Sum, type: uint",
            ],
            "",
            [("Data", "size"), ("Sum", "place")],
        ),
    ],
)
def test_fields_without_fixed_size_or_place_are_left_out_if_xtce_lacks_them(
    tmp_path, fields, before, lacks
):
    length = int(COUNTED in fields)
    _, frame = frame_of(tmp_path, *fields, length=length, before=before)
    assert frame.lacks == [
        f"`{name}`, which has no fixed {what}, is left out" for name, what in lacks
    ]
    assert [row.alias for row in frame.rows] == ["Size"][:length]


def test_notes_state_the_limits_of_the_file(tmp_path):
    _, frame = frame_of(
        tmp_path,
        "at: 0, bits: 32, name: Low, type: float, points: [[0, 1], [9, 2]],"
        " outside: clamp",
        "at: 32, bits: 8, name: A, type: uint, points: [[0, 1], [9, 2]],"
        " outside: clamp",
        length=5,
        more="    may_end_early: zeros\n    derived: [{name: Sum, formula: Low + A}]\n",
    )
    assert frame.lacks == []
    assert frame.notes == [
        "`Low`: beyond its table it has the value of the last point",
        "it is sent with the zeros that it may be sent without",
        "`Sum` is left out: it is derived by `Low + A`",
    ]


SHARED = """\
messages:
  - name: First
    id: 5
    kind: telemetry
    shares_id: true
    length: 4
    fields:
      - {at: 0, bits: 16, name: Type, type: int, const: -2, unit: s}
      - {at: 16, bits: 8, name: Kind, type: enum, enum: Kinds, const: 3}
      - {at: 24, bits: 8, name: Value, type: uint}
  - name: Second
    id: 5
    kind: telemetry
    shares_id: true
    length: 4
    reserved: 2
    fields:
      - {at: 0, bits: 16, name: Type, type: uint, const: 7}
enums:
  - {name: Kinds, members: [{value: 3, name: Three}]}
"""


def test_discriminators_are_plain_numbers_named_after_their_place(tmp_path):
    builder, (first, second) = built(tmp_path, SHARED, shared={5: 4})
    assert first.base is second.base
    (base,) = builder.bases.values()
    assert base == BaseContainer("Id5", 5, base.entries)
    assert [(e.name, e.run, e.at) for e in base.entries.values()] == [
        ("Id5_0_16_le_signed", BitRun(0, 16, True), 8),
        ("Id5_16_8", BitRun(16, 8), 24),
        ("Id5_0_16_le", BitRun(0, 16, True), 8),
    ]
    assert first.discriminators == [("Id5_0_16_le_signed", -2), ("Id5_16_8", 3)]
    assert second.discriminators == [("Id5_0_16_le", 7)]
    assert {row.name: row.type for row in builder.reserved.values()} == {
        "Id5_0_16_le_signed": "int16_le",
        "Id5_16_8": "uint8",
        "Id5_0_16_le": "uint16_le",
        "Reserved16": "uint16",
    }
    named = {name: type_ for type_, name in builder.types.names.items()}
    assert named["int16_le"].unit == ""
    # Entries of a container with a base have positions.
    assert positions(second) == [("Second_Type", 8), ("Reserved16", 24)]


def test_only_constants_within_the_shared_bytes_are_discriminators(tmp_path):
    _, (first, _) = built(tmp_path, SHARED, shared={5: 2})
    assert first.discriminators == [("Id5_0_16_le_signed", -2)]
    _, (first, _) = built(tmp_path, SHARED, shared={5: 1})
    assert first.discriminators == []


def test_telecommands_of_a_shared_id_need_no_base(tmp_path):
    text = SHARED.replace("telemetry", "telecommand")
    builder, (first, _) = built(tmp_path, text, TELECOMMAND, shared={5: 4})
    assert (builder.bases, first.base, first.discriminators) == ({}, None, [])
    assert rows(first) == [
        ("Type", 8, 16, "FEFF"),
        ("Kind", 24, 8, "03"),
        ("Value", 32, 8, None),
    ]


def test_ids_of_both_directions_are_those_of_a_configuration(tmp_path):
    text = (
        "messages:\n  - name: Gain\n    set_id: 3\n    get_id: 130\n"
        "    kind: configuration\n    length: 0\n"
    )
    for direction, id in ((TELECOMMAND, 3), (TELEMETRY, 130)):
        _, (frame,) = built(tmp_path, text, direction)
        assert (frame.name, frame.id) == ("Gain", id)

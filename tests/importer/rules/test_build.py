"""Parts of tables become messages, enumerations and structs."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.model import Extent, ReadEnum, ReadMember
from icdgen.importer.rules.build import MessageBuilder
from icdgen.importer.rules.notes import Notes
from tests.importer.rules.parts import (
    BIG_MSB,
    LITTLE,
    RULES_OF,
    draft,
    part,
    shown,
)
from tests.importer.rules.small import rule

WORDS = profile.load()


def built(*parts, order=LITTLE):
    """Return the messages, the enumerations and the findings."""
    notes = Notes()
    results = MessageBuilder(WORDS, order, notes).build_results(list(parts))
    assert all(f.place and f.help for f in notes.import_findings)
    enums = [r.content for r in results if isinstance(r.content, ReadEnum)]
    messages = [r.content for r in results if not isinstance(r.content, ReadEnum)]
    return messages, enums, shown(notes)


def fields(*drafts, **given):
    """Return the fields of a message, and the findings."""
    (message,), _, findings = built(part(*drafts, **given))
    return message.fields, findings


def test_a_message_has_the_roles_of_its_part():
    given = {"message": "Pump\u00a0 State", "kind": "telemetry", "id": "0x21"}
    given |= {"get_id": "5", "length": "2", "message_text": "Prose", "section": "Power"}
    (message,), _, findings = built(part(draft(), **given), order=BIG_MSB)
    assert findings == []
    assert (message.name, message.kind, message.ids, message.length) == (
        "Pump State",
        "telemetry",
        (0x21, None, 5),
        2,
    )
    assert (message.summary, message.group, message.bit_order) == (
        "Prose",
        "Power",
        "msb0",
    )


def test_one_id_sets_and_reads_a_configuration():
    assert built(part(id="0", kind="configuration"))[0][0].ids == (None, 0, 0)
    assert built(part(set_id="1", kind="configuration"))[0][0].ids == (None, 1, None)


def test_ids_and_lengths_that_are_no_numbers_are_reported():
    (message,), _, findings = built(part(id="x" * 50, length="4 bytes", message="A"))
    text = "table 7, message `A`: its {} is `{}`, which is not a number"
    assert findings == [
        ("IMP023", "error", text.format("id", "x" * 40)),
        ("IMP023", "error", text.format("length", "4 bytes")),
    ]
    assert (message.id, message.length) == (None, None)


def test_fields_are_sorted_and_reserved_bits_are_none():
    drafts = (draft("B", 8, 4), draft("A", 0), draft("Spare", 12, 4))
    (message,), _, findings = built(part(*drafts))
    assert [(f.name, f.at, f.bits) for f in message.fields] == [
        ("A", 0, 8),
        ("B", 8, 4),
    ]
    assert message.reserved == [Extent(12, 16, "lsb0")]
    assert findings == []
    # From the high half of byte 1 to the low half of byte 0.
    bits = [(1, n) for n in range(4, 8)] + [(0, n) for n in range(4)]
    (message,), _, _ = built(part(draft("Spare", 0, 8, frame_bits=bits)))
    assert message.reserved == [Extent(4, 12, "msb0")]


def test_a_field_in_another_order_states_what_differs():
    other = [(1, n) for n in range(8)] + [(0, n) for n in range(8)]
    ((field,), _) = fields(draft("A", 0, 16, frame_bits=other))
    assert field.facts in (
        {"byte_order": "big", "bit_order": "msb0"},
        {"byte_order": "big"},
    )
    assert fields(draft("A", facts={"min": 1}))[0][0].facts == {"min": 1}


@pytest.mark.parametrize(
    ("names", "what"),
    [
        (["A", "b", "a "], "two fields have this name"),
        (["12"], "this cannot be a name"),
        (["-"], "this cannot be a name"),
        (["A", "µ"], None),
        (["Spare", "Spare"], None),
    ],
)
def test_names_that_look_like_a_mistake_are_reported(names, what):
    drafts = [draft(name, 8 * index) for index, name in enumerate(names)]
    text = f"table 7, field `{names[-1]}`: {what}"
    assert fields(*drafts)[1] == ([("IMP107", "error", text)] if what else [])


def test_a_bool_of_several_bits_is_a_number():
    text = "table 7, field `Mode`: a bool has one bit, this one 8"
    ((field,), findings) = fields(draft(kind="bool"))
    assert (field.type, findings) == ("uint", [("IMP026", "warning", text)])
    assert fields(draft(kind="bool", bits=1))[0][0].type == "bool"


def test_an_enumeration_needs_values_or_a_reference():
    text = "table 7, field `Mode`: its values are not given"
    ((field,), findings) = fields(draft(kind="enum"))
    assert (field.type, findings) == ("uint", [("IMP050", "error", text)])
    for described in ({"enum_table": 0}, {"enum_title": "Modes"}):
        ((field,), findings) = fields(draft(kind="enum", described=described))
        assert (field.type, findings) == ("enum", [])


OFF, ON = (0, "Off"), (1, "On")


def test_fields_with_equal_members_share_an_enumeration():
    def mode(at: int, *members, name="Mode", **roles):
        return draft(name, at, kind="enum", members=list(members), roles=roles)

    first = part(mode(0, OFF), mode(8, ON, name="mode "), message="A", number=1)
    second = part(mode(0, OFF), message="B", number=3)
    third = part(mode(0, ON), mode(8, OFF, ON), message="C", number=2)
    third.drafts[1].name = "Mode"
    fourth = part(mode(0, OFF, enumeration="Own"), message="D", number=4)
    messages, enums, _ = built(first, second, third, fourth)
    assert [[f.enum for f in m.fields] for m in messages] == [
        ["Mode", "mode "],
        ["C Mode", "C Mode 8"],
        ["Mode"],
        ["Own"],
    ]
    assert [(e.name, e.members, e.table.number) for e in enums] == [
        ("Mode", [ReadMember(*OFF)], 1),
        ("mode ", [ReadMember(*ON)], 1),
        ("C Mode", [ReadMember(*ON)], 2),
        ("C Mode 8", [ReadMember(*OFF), ReadMember(*ON)], 2),
        ("Own", [ReadMember(*OFF)], 4),
    ]


def test_results_are_in_the_order_of_the_tables():
    named = part(
        own=RULES_OF["enumeration"], enumeration="Modes", pairs=[OFF], number=2
    )
    named.texts = [""]
    builder = MessageBuilder(WORDS, LITTLE, Notes())
    parts = [part(message="B", number=3), named, part(message="A", number=1)]
    results = builder.build_results(parts)
    assert [(r.what, r.content.name) for r in results] == [
        ("message", "A"),
        ("enumeration", "Modes"),
        ("message", "B"),
    ]


def joined(first, second, **second_keys):
    parts = [
        part(*first, number=1, message="A", id="3", kind="telemetry"),
        part(*second, **{"number": 2, "id": "3", "kind": "telemetry"} | second_keys),
    ]
    messages, _, findings = built(*parts)
    return [[f.name for f in m.fields] for m in messages], findings


def test_consecutive_tables_of_one_message_are_joined():
    a, b = [draft("A", 8)], [draft("B", 0)]
    assert joined(a, b) == ([["B", "A"]], [])
    for other in ({"id": "4"}, {"kind": "telecommand"}, {"get_id": "3"}):
        assert len(joined(a, b, **other)[0]) == 2, other
    assert len(joined(a, b, own=rule())[0]) == 2
    # Several parts of one table are messages of their own.
    parts = [part(draft(), id="3"), part(draft("B", 8), id="3")]
    parts[1].table = parts[0].table
    assert len(built(*parts)[0]) == 2


def test_tables_of_one_message_whose_fields_overlap_are_not_joined():
    text = "table 2: table 1 describes a message of the same id, and fields of both overlap"
    assert joined([draft("A", 0)], [draft("B", 7, 1)]) == (
        [["A"], ["B"]],
        [("IMP105", "error", text)],
    )
    assert joined([draft("A", 0)], [draft("B", 8, 1)])[0] == [["A", "B"]]
    assert joined([draft("A", 8)], [draft("B", 0, 9)])[0] == [["A"], ["B"]]
    assert joined([draft("A", 8)], [draft("B", 0, 8)])[0] == [["B", "A"]]


def test_only_neighbouring_tables_of_a_message_are_joined():
    given = {"id": "3", "kind": "telemetry"}
    tables = [
        part(draft("A", 0), number=1, **given),
        part(draft("B", 8), number=2, **given),
        part(draft("C", 0), number=3, **given | {"id": "4"}),
        part(draft("D", 16), number=4, **given),
    ]
    messages, _, findings = built(*tables)
    assert [[f.name for f in m.fields] for m in messages] == [["A", "B"], ["C"], ["D"]]
    assert findings == []
    # Tables without an id are messages of their own.
    assert len(built(part(number=1, kind="x"), part(number=2, kind="x"))[0]) == 2


def grouped(*drafts, **roles):
    """Return the structs and fields of a message with a group `G`, and the findings."""
    for item in drafts:
        item.roles.given = {"group": "G", **roles, **item.roles.given}
    (message,), _, findings = built(part(*drafts, message="State"))
    structs = [
        (s.name, s.length, [(f.name, f.at, f.bits, f.facts) for f in s.fields])
        for s in message.structs
    ]
    arrays = [(f.name, f.at, f.bits, f.type, f.facts) for f in message.fields]
    return structs, arrays, findings


def pair():
    return draft("Y", 24, 4, facts={"min": 1, "count": 3}), draft("X", 16)


STRUCT = ("State G", 2, [("X", 0, 8, {}), ("Y", 8, 4, {"min": 1})])


@pytest.mark.parametrize(
    ("roles", "facts"),
    [
        ({"count": "3"}, {"count": 3}),
        ({"count": "3", "up_to": "9", "stride": "2"}, {"count": 3}),
        ({"counter": "N", "up_to": "9"}, {"count": "N", "up_to": 9}),
        ({"rest": "x", "count": "3", "up_to": "9"}, {"count": "rest", "up_to": 9}),
        ({"counter": "N", "rest": "x", "up_to": "9"}, {"count": "N", "up_to": 9}),
    ],
)
def test_fields_of_a_group_are_an_array_of_structs(roles, facts):
    array = ("G", 16, 16, "struct", {"struct": "State G"} | facts)
    assert grouped(*pair(), **roles) == ([STRUCT], [array], [])


@pytest.mark.parametrize(
    ("roles", "message"),
    [
        ({}, "the number of repetitions of the group `G` is not given"),
        ({"counter": "N"}, "the number of repetitions of the group `G` is not given"),
        ({"rest": "x"}, "the number of repetitions of the group `G` is not given"),
        ({"count": "3", "stride": "3"},
         "the fields of the group `G` need 2 bytes, its elements stand 3 bytes apart"),
    ],
)  # fmt: skip
def test_a_group_without_a_number_or_with_another_distance_is_reported(roles, message):
    message = f"table 7, message `State`: {message}"
    assert grouped(*pair(), **roles) == ([], [], [("IMP105", "error", message)])


def test_a_group_has_one_distance():
    first, second = pair()
    first.roles.given["stride"] = "3"
    _, _, ((_, _, message),) = grouped(first, second, count="3", stride="2")
    assert message.endswith("need 2 bytes, its elements stand 2 and 3 bytes apart")


def test_formulas_that_contradict_their_announcement_are_one_finding():
    def announced(name: str, at: int, word: str):
        return draft(name, at, described={"formula": "raw*2", "formula_for": word})

    drafts = [
        announced("A", 0, "raw"),
        announced("B", 8, "raw"),
        announced("C", 16, "raw"),
    ]
    text = "table 7: the formula of `{}{} is announced as giving the {} value and gives the {} one"
    physical = [announced("D", 24, "physical"), announced("E", 32, "physical")]
    _, findings = fields(*drafts, *physical)
    assert findings == [
        (
            "IMP041",
            "warning",
            text.format("A`", " and of 2 more fields", "raw", "physical"),
        ),
        (
            "IMP041",
            "warning",
            text.format("D`", " and of 1 more field", "physical", "raw"),
        ),
    ]


def test_a_formula_that_contradicts_its_announcement_is_named_alone():
    described = {"formula": "raw*2", "formula_for": "raw"}
    ((_, _, message),) = fields(draft("A", described=described))[1]
    assert message.startswith("table 7: the formula of `A` is announced as")


def test_registers_are_as_long_as_their_part_or_their_fields():
    own = RULES_OF["registers"]
    (message,), _, _ = built(part(draft("A", 0), own=own, length="3"), order=BIG_MSB)
    assert [(f.at, f.bits) for f in message.fields] == [(16, 8)]
    drafts = draft("A", 0), draft("B", 8, 5)
    (message,), _, _ = built(part(*drafts, own=own), order=BIG_MSB)
    assert [(f.name, f.at) for f in message.fields] == [("B", 3), ("A", 8)]


def test_a_struct_has_as_many_bytes_as_its_fields_need():
    for bits, length in ((7, 1), (8, 1), (9, 2)):
        ((_, size, _),), _, _ = grouped(draft("X", 16, bits), count="2")
        assert size == length

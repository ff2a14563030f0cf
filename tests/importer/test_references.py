"""Lists complete and contradict messages; fields find their enumerations."""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.descriptions import Described
from icdgen.importer.document import SourceTable
from icdgen.importer.model import (
    Extent,
    Listed,
    NodeParts,
    ReadEnum,
    ReadField,
    ReadList,
    ReadMember,
    ReadMessage,
)
from icdgen.importer.references import (
    check_messages,
    compare_with_lists,
    resolve_enumerations,
)
from tests.limits import assert_limits

SPOT = SourcePlace(line=5)


def message(name="State", kind="telemetry", number=4, **keys) -> ReadMessage:
    label = keys.pop("label", None)
    run = keys.pop("run", 1)
    table = SourceTable(number=number, label=label, run=run)
    return ReadMessage(name, kind, table, **keys)


def listed(name="State", kind="telemetry", **keys) -> Listed:
    given = {"length": None, "id": None, "set_id": None, "get_id": None, "group": ""}
    return Listed(kind, name, **given | keys, spot=SourcePlace(line=9, table=2))


def compared(messages, *rows, kind="telemetry") -> tuple[NodeParts, list[tuple]]:
    node = NodeParts("pump", "Pump", messages=messages)
    node.lists = [ReadList(kind, "", list(rows))] if rows else []
    findings: list = []
    compare_with_lists(node, findings)
    return node, [(f.code, f.message, f.spot.line, f.sure) for f in findings]


def test_a_message_takes_its_group_and_missing_facts_from_a_list():
    item = message("", "", id=3)
    row = listed("State", id=3, length=4, group="Power")
    node, findings = compared([item], row)
    assert (item.name, item.kind, item.length, item.group) == (
        "State",
        "telemetry",
        4,
        "Power",
    )
    text = "table 4: it does not say its length; the list says 4"
    assert findings == [("IMP063", text, None, "likely")]
    assert (item.listed, node.missing, row.used) == ({}, [], True)


def test_contradictions_with_a_list_are_stored_and_reported():
    item = message("State", "telemetry", id=3, length=4, set_id=7)
    row = listed("Status", id=4, length=6, set_id=8)
    row.name = "state"
    _, findings = compared([item], row)
    assert item.listed == {"name": "state", "length": 6, "id": 4, "set_id": 8}
    assert (item.name, item.length, item.id, item.set_id) == ("State", 4, 3, 7)
    says = "table 4: its {} is `{}`, the list (table 2) says `{}`"
    assert findings == [
        ("IMP060", says.format(*values), None, "likely")
        for values in (
            ("name", "State", "state"),
            ("length", 4, 6),
            ("id", 3, 4),
            ("set id", 7, 8),
        )
    ]


def test_a_name_that_differs_in_blanks_only_is_no_contradiction():
    item = message("Pump\u00a0State", id=3)
    assert compared([item], listed("Pump  State", id=3))[1] == []
    assert item.listed == {}


def test_a_row_is_that_of_the_kind_and_the_id_or_else_of_the_name():
    by_name, by_id = listed("State", id=9), listed("Other", id=3)
    item = message("State", id=3)
    node, _ = compared([item], by_name, by_id)
    assert (by_name.used, by_id.used, node.missing) == (False, True, [by_name])
    # The kinds differ.
    command = listed("State", "telecommand", id=3)
    assert compared([message("State", id=3)], command)[0].missing == [command]
    # A row without a kind is of each, and a row is used once.
    row = listed("STATE.", "", id=9)
    first, second = message("State", id=3), message("State", "telecommand", id=4)
    compared([first, second], row)
    assert (first.listed, second.listed) == ({"name": "STATE.", "id": 9}, {})
    assert (first.kind, second.kind) == ("telemetry", "telecommand")


@pytest.mark.parametrize(
    ("kind", "is_reported"), [("telemetry", True), ("", True), ("telecommand", False)]
)
def test_a_message_that_no_list_of_its_kind_names_is_reported(kind, is_reported):
    row = listed("Other", kind, id=9)
    node, findings = compared([message("State", id=3)], row, kind=kind)
    lost = ("IMP061", "`Other` is listed, and no table describes it", 9, "doubtful")
    text = "table 4: no list table names it"
    expected = [("IMP062", text, None, "likely")] if is_reported else []
    assert findings == [*expected, lost]
    assert node.missing == [row]
    assert compared([message("State", id=3)])[1] == []


def enum(name: str, label=None, run=1, caption="", table=None) -> ReadEnum:
    table = table or SourceTable(number=1, label=label, run=run, caption=caption)
    return ReadEnum(name, [ReadMember(0, "Off")], table)


def resolved(enums, own=None, label=None, **described) -> tuple:
    """Return type and enumeration of a field in run 1, and the findings.

    ``enums`` are those of the document, ``own`` those of the node.
    """
    field = ReadField("Mode", 0, 8, "enum", Described(**described), SPOT)
    node = NodeParts("pump", "Pump", messages=[message(fields=[field])])
    node.enums = list(enums if own is None else own)
    findings: list = []
    resolve_enumerations(node, [node], list(enums), findings)
    name = "table 4, field `Mode`: "
    assert all(f.message.startswith(name) and f.spot == SPOT for f in findings)
    reports = [(f.code, f.severity, f.message.removeprefix(name)) for f in findings]
    return field.type, field.enum, reports


def unresolved(what: str) -> tuple:
    return "uint", "", [("IMP050", "error", what)]


def test_a_field_finds_its_enumeration_by_the_number_of_a_table():
    enums = [enum("A", 8), enum("B", 9)]
    assert resolved(enums, enum_table=9) == ("enum", "B", [])
    what = "it points to table 7, which is not there or no enumeration"
    assert resolved(enums, enum_table=7) == unresolved(what)
    # A table without a number is none that a field without a reference means.
    what = "it does not say in which table its values are"
    assert resolved([enum("A")]) == unresolved(what)


def test_the_table_in_the_part_of_the_message_precedes_others_of_its_number():
    enums = [enum("A", 8, run=2), enum("B", 8, run=1), enum("C", 8, run=3)]
    assert resolved(enums, enum_table=8) == ("enum", "B", [])
    assert resolved(enums[::2], enum_table=8) == ("enum", "A", [])


def test_a_field_finds_its_enumeration_by_title():
    enums = [enum("Pump Mode", 8), enum("Valve", 9, caption="Valve Modes")]
    assert resolved(enums, enum_title="PUMP-mode") == ("enum", "Pump Mode", [])
    assert resolved(enums, enum_title="valve modes") == ("enum", "Valve", [])
    what = "there is no enumeration `Motor`"
    assert resolved(enums, enum_title="Motor") == unresolved(what)


def test_a_title_may_be_broken_off_behind_six_letters():
    enums = [enum("PumpMode Values", 8, caption="PumpMode Values of A")]

    def is_found(length: int) -> bool:
        return resolved(enums, enum_title="PumpModeV"[:length])[0] == "enum"

    assert_limits(is_found, least=6)
    # The caption begins in the same way, but the name does not.
    other = [enum("Other", 8, caption="PumpMode Values of A")]
    assert resolved(other, enum_title="PumpMode")[0] == "uint"
    both = [*enums, enum("PumpMode States", 9, caption="PumpMode States")]
    assert resolved(both, enum_title="PumpMode")[0] == "uint"
    again = [*enums, enum("PumpMode-Values", 9, caption="PumpMode Values of B")]
    assert resolved(again, enum_title="PumpMode")[1] == "PumpMode Values"


def test_the_title_is_followed_if_number_and_title_contradict_each_other():
    enums = [enum("A", 8), enum("B", 9)]
    what = "it points to table 8 by number and to table 9 (`B`) by title"
    report = [("IMP051", "warning", what)]
    assert resolved(enums, enum_table=8, enum_title="B") == ("enum", "B", report)
    assert resolved(enums, enum_table=8, enum_title="A") == ("enum", "A", [])
    # A title that is none of an enumeration does not contradict the number.
    assert resolved(enums, enum_table=8, enum_title="Z") == ("enum", "A", [])
    # The number is that of no enumeration.
    assert resolved(enums, enum_table=7, enum_title="B") == ("enum", "B", [])


def test_a_table_of_several_enumerations_needs_a_title():
    table = SourceTable(number=1, label=8, caption="Modes")
    enums = [enum(name, table=table) for name in "ABCD"]
    what = "it points to table 8, which has 4 enumerations: `A` and `B` and `C`"
    assert resolved(enums, enum_table=8) == unresolved(what)
    assert resolved(enums, enum_table=8, enum_title="B") == ("enum", "B", [])
    what = "it points to table 8, which has 2 enumerations: `A` and `B`"
    assert resolved(enums[:2], enum_table=8) == unresolved(what)
    assert resolved(enums, enum_title="Modes")[0] == "uint"


def test_an_enumeration_of_another_node_is_copied_once_unless_it_is_included():
    shared = enum("Mode", 8)
    fields = [
        ReadField("A", 0, 8, "enum", Described(enum_table=8), SPOT) for _ in range(2)
    ]
    node = NodeParts("pump", "Pump", messages=[message(fields=fields)])
    common = NodeParts("common", "Common", enums=[shared])
    resolve_enumerations(node, [node, common], [shared], [])
    assert node.enums == [shared]
    node = NodeParts("pump", "Pump", messages=[message(fields=fields)])
    node.include = ["common.yaml"]
    for field in fields:
        field.enum = ""
    # The included node has merged the table with another of the same content.
    common.enums = [enum("Merged", 3)]
    common.enums[0].also = [shared.table]
    resolve_enumerations(node, [node, common], [shared], [])
    assert (node.enums, [field.enum for field in fields]) == ([], ["Merged"] * 2)


def test_only_fields_of_enumerations_without_a_name_are_resolved():
    enums = [enum("A", 8)]
    given = ReadField("X", 0, 8, "enum", Described(enum_table=8), SPOT, enum="B")
    number = ReadField("Y", 8, 8, "uint", Described(enum_table=8), SPOT)
    node = NodeParts("pump", "Pump", [], messages=[message(fields=[given, number])])
    resolve_enumerations(node, [node], enums, [])
    assert (given.enum, number.enum, number.type) == ("B", "", "uint")


def checked(item: ReadMessage, **head) -> tuple[bool, list[tuple]]:
    """Return whether the message remains, and the findings."""
    node = NodeParts("pump", "Pump", messages=[item])
    findings: list = []
    check_messages(node, head, findings)
    assert all(f.message.startswith("table 4: ") for f in findings)
    return node.messages == [item], [
        (f.code, f.severity, f.message.removeprefix("table 4: ")) for f in findings
    ]


@pytest.mark.parametrize(("head", "most"), [({}, 255), ({"id_bits": 16}, 65535)])
def test_a_message_with_an_id_above_the_largest_is_left_out(head, most):
    for key in ("id", "set_id", "get_id"):

        def is_kept(number: int, key: str = key) -> bool:
            kept, findings = checked(message(**{key: number}, length=0), **head)
            text = f"its id {number} (0x{number:X}) is above {most}"
            assert findings == ([] if kept else [("IMP037", "error", text)])
            return kept

        assert_limits(is_kept, most=most)


@pytest.mark.parametrize(
    ("keys", "lacking"),
    [
        ({"name": ""}, "name"),
        ({"kind": ""}, "kind"),
        ({"id": None}, "id"),
        ({"name": "", "kind": "", "id": None}, "name and no kind and no id"),
    ],
)
def test_a_message_without_name_kind_or_id_is_left_out(keys, lacking):
    text = f"its rule gives no {lacking}; the message was left out"
    result = checked(message(**{"id": 3, "length": 0} | keys))
    assert result == (False, [("IMP031", "error", text)])
    assert checked(message(id=0, length=0)) == (True, [])
    assert checked(message(get_id=0, length=0)) == (True, [])


def test_a_message_without_a_length_has_that_of_its_fields():
    field = ReadField("X", 0, 9, "uint", Described(), SPOT)
    item = message(id=3, fields=[field], reserved=[Extent(9, 16, "lsb0")])
    text = "it does not say its length; the fields need {} byte{}"
    assert checked(item) == (True, [("IMP032", "note", text.format(2, "s"))])
    assert item.length == 2
    item = message(id=3, reserved=[Extent(0, 8, "lsb0")])
    _, findings = checked(item)
    assert findings[0] == ("IMP032", "note", text.format(1, ""))
    item = message(id=3)
    assert checked(item)[1] == [("IMP032", "note", text.format(0, "s"))]
    assert item.length == 0


def test_fields_that_need_more_bytes_than_the_message_has_are_reported():
    def is_accepted(bits: int) -> bool:
        field = ReadField("X", 0, bits, "uint", Described(), SPOT)
        kept, findings = checked(message(id=3, length=2, fields=[field]))
        assert kept
        text = "its fields need 3 bytes, its length is 2"
        assert findings in ([], [("IMP033", "warning", text)])
        return not findings

    assert is_accepted(16) and not is_accepted(17)


def test_bits_without_a_field_are_reported():
    fields = [ReadField("X", at, 4, "uint", Described(), SPOT) for at in (1, 6)]
    item = message(id=3, length=2, fields=fields, reserved=[Extent(11, 16, "lsb0")])
    assert checked(item) == (
        True,
        [("IMP035", "warning", "no field covers bit 0, 5, 10")],
    )
    item.reserved = []
    assert checked(item)[1][0][2] == "no field covers bit 0, 5, 10 to 15"
    empty = message(id=3, length=2)
    assert checked(empty) == (
        True,
        [("IMP034", "error", "it has 2 bytes and no field")],
    )

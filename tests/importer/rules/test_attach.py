"""Tables of values, points and bits belong to fields; an index completes messages."""

from __future__ import annotations

import pytest

from icdgen.importer.document import SourceTable
from icdgen.importer.model import ReadMessage, TableResult
from icdgen.importer.rules.attach import attach, check_index
from icdgen.importer.rules.notes import Notes
from tests.importer.rules.parts import (
    BIG_LSB,
    BIG_MSB,
    LITTLE,
    RULES_OF,
    draft,
    part,
    shown,
)


def of(what: str, field: str, *drafts, **keys):
    return part(*drafts, own=RULES_OF[what], of=field, **keys)


def attached(parts, messages, order=LITTLE) -> list[tuple[str, str, str]]:
    notes = Notes()
    attach([*messages, *parts], messages, order, notes)
    assert all(f.place and f.help for f in notes.import_findings)
    return shown(notes)


VALUES = [(0, "Off"), (1, "On")]


def test_values_belong_to_all_fields_of_the_name_that_the_table_gives():
    state, other = draft("Pump mode"), draft("Pump mode")
    load = draft("Load")
    messages = [part(state, load, message="A"), part(other, message="B", number=9)]
    values = of("enumeration", "PUMP-Mode", pairs=VALUES)
    assert attached([values], messages) == []
    assert [(d.kind, d.members) for d in (state, other, load)] == [
        ("enum", VALUES),
        ("enum", VALUES),
        ("uint", []),
    ]


def test_values_belong_to_a_field_of_the_message_that_the_table_gives():
    first, second = draft(), draft()
    messages = [part(first, message="A"), part(second, message="State B")]
    values = of("enumeration", "Mode", pairs=VALUES, message="state b")
    assert attached([values], messages) == []
    assert (first.members, second.members) == ([], VALUES)


def test_each_of_several_tables_of_values_belongs_to_the_nearest_message_above_it():
    fields = [draft() for _ in range(3)]
    messages = [
        part(field, message=name, number=number)
        for field, name, number in zip(fields, "ABC", (1, 3, 5), strict=True)
    ]
    # A table may have both the message and the values.
    tables = [of("enumeration", "Mode", pairs=[(n, "x")], number=n) for n in (2, 5)]
    assert attached(tables, messages) == []
    assert [field.members for field in fields] == [[(2, "x")], [], [(5, "x")]]
    above = of("enumeration", "Mode", pairs=VALUES, number=0)
    text = "table 0: there is no field `Mode` for this enumeration"
    assert attached([above, *tables], messages) == [("IMP107", "error", text)]


def test_tables_for_another_message_or_of_another_kind_are_no_rivals():
    first, second = draft(), draft()
    messages = [part(first, message="A"), part(second, message="B")]
    tables = [
        of("enumeration", "Mode", pairs=VALUES),
        of("enumeration", "Mode", pairs=VALUES[:1], message="B"),
        of("lookup", "Mode", pairs=[(1, "2")]),
    ]
    assert attached(tables, messages) == []
    assert (first.members, second.members) == (VALUES, VALUES[:1])
    assert first.facts == second.facts == {"points": [[1, 2.0]]}


@pytest.mark.parametrize("what", ["enumeration", "lookup", "bits"])
def test_a_table_without_its_field_is_reported(what):
    messages = [part(draft(), message="A")]
    text = f"table 7: there is no field `Load` in a message `B` for this {what}"
    table = of(what, "Load", message="B")
    assert attached([table], messages) == [("IMP107", "error", text)]
    text = f"table 7: there is no field `` for this {what}"
    assert attached([part(own=RULES_OF[what])], messages) == [("IMP107", "error", text)]


def test_an_enumeration_with_a_name_of_its_own_belongs_to_no_field():
    field = draft()
    named = of("enumeration", "Mode", pairs=VALUES, enumeration="Modes")
    assert attached([named], [part(field)]) == []
    assert field.members == []


def test_points_of_a_lookup_table_ascend():
    field = draft()
    points = of("lookup", "Mode", pairs=[(9, "1e2"), (-1, ".5"), (0, "−3")])
    assert attached([points], [part(field)]) == []
    assert field.facts == {"points": [[-1, 0.5], [0, -3.0], [9, 100.0]]}
    text = "table 7: a point of the lookup table of `Mode` is no number"
    field = draft()
    for point in ("x", "1e400"):
        wrong = of("lookup", "Mode", pairs=[(9, "1"), (0, point)])
        assert attached([wrong], [part(field)]) == [("IMP023", "error", text)]
    assert field.facts == {}


def divided(*bits, host=None, order=LITTLE):
    """Return the fields in place of a field of 16 bits, and the findings."""
    host = host or draft("State", 8, 16)
    message = part(draft("First"), host, draft("Last", 24))
    findings = attached([of("bits", "State", *bits, number=9)], [message], order)
    first, *inner, last = message.drafts
    assert (first.name, last.name) == ("First", "Last")
    assert all(d.table is not None and d.table.number == 9 for d in inner)
    return [(d.name, d.at, d.bits, d.order) for d in inner], findings


LOW, HIGH = draft("Low", 0, 4), draft("High", 4, 12)


@pytest.mark.parametrize(
    ("order", "low", "high"),
    [
        (LITTLE, (8, None), (12, None)),
        (BIG_MSB, (20, None), (8, None)),
        # The low bits of the value are in its last byte.
        (BIG_LSB, (16, None), (8, BIG_MSB)),
    ],
)
def test_bits_are_counted_from_the_least_significant_bit_of_the_value(order, low, high):
    result, findings = divided(LOW, HIGH, order=order)
    assert findings == []
    assert [(at, own) for _, at, _, own in result] == [low, high]
    assert [(name, bits) for name, _, bits, _ in result] == [("Low", 4), ("High", 12)]
    # The order of the field precedes that of the node.
    own = draft("State", 8, 16, order=BIG_MSB)
    assert divided(LOW, host=own)[0] == [("Low", 16, 4, None)]


def test_missing_bits_and_bits_above_the_field_are_reported():
    text = "table 9: the bits of `State` leave out or exceed its bits: {}"

    def warning(shown: str) -> tuple:
        return "IMP105", "warning", text.format(shown)

    assert divided(LOW, draft("X", 5, 10))[1] == [warning("4, 15")]
    above = draft("X", 4, 13)
    error = "table 9: `X` does not fit into the bits of `State`"
    result, findings = divided(LOW, above)
    assert findings == [warning("16 and above"), ("IMP105", "error", error)]
    assert [name for name, *_ in result] == ["Low"]


def test_bits_of_a_field_of_a_group_are_in_the_group():
    roles = {"group": "G", "count": "3", "text": "x", "stride": "2", "name": "State"}
    host = draft("State", 8, 16, roles=roles)
    message = part(host)
    attached([of("bits", "State", draft("A", 0, 16, roles={"unit": "V"}))], [message])
    shared = {"unit": "V", "group": "G", "count": "3", "stride": "2"}
    assert [d.roles.given for d in message.drafts] == [shared]
    host = draft("State", 8, 16, roles={"count": "3"})
    message = part(host)
    attached([of("bits", "State", draft("A", 0, 16))], [message])
    assert [d.roles.given for d in message.drafts] == [{}]


def test_bits_replace_the_field_that_they_divide_and_none_of_equal_content():
    twins = [draft("State", 8, 16), draft("State", 8, 16)]
    message = part(*twins)
    attached([of("bits", "State", LOW, HIGH)], [message])
    assert [d.name for d in message.drafts] == ["Low", "High"] * 2


def message(name="State", kind="telemetry", **keys) -> ReadMessage:
    return ReadMessage(name, kind, SourceTable(number=1), **keys)


def indexed(messages, **given: str) -> list[tuple[str, str, str]]:
    notes = Notes()
    results = [TableResult(item.table, "message", item) for item in messages]
    results.insert(0, TableResult(SourceTable(), "", None))
    check_index([part(own=RULES_OF["index"], **given)], results, notes)
    return shown(notes)


def test_an_index_completes_messages_by_id_or_name():
    by_id = message("", "", id=3)
    assert indexed([by_id], id="3", message="State", kind="telemetry", length="4") == []
    assert (by_id.name, by_id.kind, by_id.length) == ("State", "telemetry", 4)
    by_name = message("state!", "")
    assert indexed([by_name], id="3", message="State", kind="telecommand") == []
    assert (by_name.id, by_name.name, by_name.kind) == (3, "state!", "telecommand")
    get = message("", get_id=3)
    assert indexed([get], id="3", message="State") == []
    assert (get.id, get.get_id, get.name) == (None, 3, "State")


@pytest.mark.parametrize(
    ("own", "stated", "ids"),
    [
        ("configuration", "", (None, 3, 3)),
        ("", "configuration", (None, 3, 3)),
        ("telemetry", "", (3, None, None)),
    ],
)
def test_an_id_of_an_index_sets_and_reads_a_configuration(own, stated, ids):
    item = message("State", own)
    assert indexed([item], id="3", message="State", kind=stated) == []
    assert item.ids == ids


def test_contradictions_with_an_index_are_reported():
    item = message("State", set_id=5, length=2)
    given = {"id": "3", "message": "State", "kind": "telecommand", "length": "4"}
    text = "table 7: it gives `State` the {}, its own table says {}"
    assert indexed([item], **given) == [
        ("IMP060", "error", text.format(*values))
        for values in (
            ("id 3", 5),
            ("kind telecommand", "telemetry"),
            ("length 4", 2),
        )
    ]
    assert (item.ids, item.kind, item.length) == ((None, 5, None), "telemetry", 2)
    equal = {"id": "5", "message": "State", "kind": "telemetry", "length": "2"}
    assert indexed([item], **equal) == []


def test_a_row_of_an_index_without_a_table_is_reported():
    text = "table 7: it lists `{}`, and no table describes it"
    found = [("IMP061", "warning", text.format("Load"))]
    assert indexed([message(id=3)], id="4", message="Load") == found
    found = [("IMP061", "warning", text.format(4))]
    assert indexed([message("", id=3)], id="4") == found


def test_an_unknown_kind_of_an_index_is_reported_and_not_used():
    item = message("State", "")
    text = (
        "table 7, row of `State`: its kind `TM` is none of telecommand, telemetry, "
        "configuration"
    )
    assert indexed([item], message="State", kind="TM") == [("IMP031", "error", text)]
    assert item.kind == ""

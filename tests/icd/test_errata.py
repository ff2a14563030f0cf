"""Errata overlays: the places that `where` names, the changes, and the findings about
the overlay itself.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from icdgen.diagnostics import Finding
from icdgen.icd import errata
from icdgen.icd.errata import AppliedErrata
from icdgen.icd.erratum import Erratum
from icdgen.icd.located import Map
from icdgen.icd.source import parse
from tests.limits import assert_limits

ICD = """\
node: {name: demo}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 1, name: Busy}]}
  - {name: State, members: [{value: 0, name: Zero}]}
structs:
  - name: Pair
    fields: [{name: Left, bits: 8}, {name: Right, bits: 8}]
messages:
  - name: Status
    acknowledge: true
    fields: [{name: Voltage, bits: 8, unit: mV}, {name: Current, bits: 8, unit: mA}]
  - name: State
    fields: [{name: Voltage, bits: 8, unit: mV}]
loggable: [{bit: 3, message: Status}, {bit: 4, message: State}]
protocol: {link: {packets: [{name: one}, {name: two}]}}
"""


def tree() -> Map:
    return parse(ICD.encode(), "demo.yaml")


def overlay(*entries: str, notes: tuple[str, ...] = ()) -> Map:
    """Return an overlay; each entry and note begins in a line of its own."""
    text = "errata: 1\nnode: demo\n"
    for key, items in ("entries", entries), ("notes", notes):
        rows = "".join(f"  - {{{item}}}\n" for item in items)
        text += f"{key}:\n{rows}" if rows else ""
    return parse(text.encode(), "errata.yaml")


def apply(target: Map, *entries: str, notes: tuple[str, ...] = ()) -> AppliedErrata:
    return errata.apply(target, overlay(*entries, notes=notes))


def rows(applied: AppliedErrata) -> list[str]:
    return [
        f"{finding.place.line}:{finding.place.column} {finding.code} {finding.message}"
        for finding in applied.findings
    ]


def marked(value: object, path: str = "") -> Iterator[str]:
    """Yield the paths of the mappings that have the key `mark`."""
    if isinstance(value, dict):
        if "mark" in value:
            yield path
        for key, item in value.items():
            yield from marked(item, f"{path}.{key}".strip("."))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from marked(item, f"{path}.{index}")


STATUS, STATE, PAIR = "messages.0", "messages.1", "structs.0"


@pytest.mark.parametrize(
    ("where", "paths"),
    [
        ("{message: Status}", [STATUS]),
        ("{message: State}", [STATE]),
        ("{message: Status, field: Current}", [f"{STATUS}.fields.1"]),
        (
            "{message: Status, fields: [Current, Voltage]}",
            [f"{STATUS}.fields.0", f"{STATUS}.fields.1"],
        ),
        ("{message: '*'}", [STATUS, STATE]),
        ("{message: '*', field: Voltage}", [f"{STATUS}.fields.0", f"{STATE}.fields.0"]),
        (
            "{message: Status, field: '*'}",
            [f"{STATUS}.fields.0", f"{STATUS}.fields.1"],
        ),
        ("{struct: Pair}", [PAIR]),
        ("{struct: Pair, field: Right}", [f"{PAIR}.fields.1"]),
        ("{enum: State}", ["enums.1"]),
        ("{enum: Mode, member: 1}", ["enums.0.members.1"]),
        ("{loggable: 4}", ["loggable.1"]),
        ("{section: protocol.link}", ["protocol.link"]),
        ("{section: protocol.link.packets.1}", ["protocol.link.packets.1"]),
        ("[{message: State}, {enum: State}]", ["enums.1", STATE]),
    ],
)
def test_an_entry_changes_exactly_the_places_that_where_names(where, paths):
    target = tree()
    applied = apply(
        target, f"id: D-1, where: {where}, held: {{mark: 1}}, places: {len(paths)}"
    )
    assert list(marked(target)) == paths
    assert rows(applied) == []
    assert len(applied.by_mapping) == len(paths)


@pytest.mark.parametrize(
    ("where", "text", "fix"),
    [
        ("{message: Statu}", "message `Statu`", "Status"),
        ("{struct: Pairs}", "struct `Pairs`", "Pair"),
        ("{struct: Pair, field: Rigth}", "field `Rigth` in struct `Pair`", "Right"),
        ("{message: State, field: Current}", "field `Current` in message `State`", ""),
        (
            "{message: Status, fields: [Curent]}",
            "field `['Curent']` in message `Status`",
            "",
        ),
        ("{enum: Modes}", "enumeration `Modes`", "Mode"),
        ("{enum: Mode, member: 2}", "enumeration `Mode` with value 2", ""),
        ("{enum: Mods, member: 0}", "enumeration `Mods` with value 0", "Mode"),
        ("{loggable: 5}", "loggable bit 5", ""),
        ("{section: protocol.link.packets.2}", "section `protocol.link.packets.2`", ""),
        ("{section: protocol.link.packets}", "section `protocol.link.packets`", ""),
        ("{section: node.name.first}", "section `node.name.first`", ""),
    ],
)
def test_a_place_that_does_not_exist_is_reported_with_a_similar_name(where, text, fix):
    target = tree()
    entry = f"id: D-1, where: {where}, held: {{mark: 1}}"
    (finding,) = apply(target, entry).findings
    assert list(marked(target)) == []
    assert (finding.code, finding.message) == ("ICD081", f"there is no {text}")
    if fix:
        assert finding.help == f"did you mean `{fix}`?"
        assert finding.fix.text == fix
        wrong = where.rpartition(": ")[2] if "member" not in where else "Mods}"
        begin = len("  - {") + entry.index(wrong[:-1]) + 1
        assert (finding.fix.place.line, finding.fix.place.column) == (4, begin)
    else:
        assert finding.help == "names are the manual's, to the letter"
        assert finding.fix is None


def test_only_places_with_the_printed_values_are_changed():
    target = tree()
    applied = apply(
        target,
        "id: D-1, where: {message: Status, fields: [Voltage, Current]}, "
        "printed: {bits: 8, unit: mA}, held: {unit: A}",
    )
    units = [field["unit"] for field in target["messages"][0]["fields"]]
    assert units == ["mV", "A"]
    assert rows(applied) == [
        "4:94 ICD080 stale erratum D-1: it was written for `unit: mA`, the ICD now has "
        "`unit: mV` (demo.yaml:11:45)"
    ]


@pytest.mark.parametrize("printed", ["1", "'true'", "false", "null"])
def test_a_printed_flag_equals_no_number_and_no_text(printed):
    target = tree()
    entry = f"id: D-1, where: {{message: Status}}, printed: {{acknowledge: {printed}}}"
    (finding,) = apply(target, f"{entry}, held: {{acknowledge: false}}").findings
    assert finding.message.endswith("now has `acknowledge: true` (demo.yaml:10:18)")
    assert target["messages"][0]["acknowledge"] is True


def test_a_printed_value_of_null_means_that_the_key_is_absent():
    target = tree()
    where = "where: {message: Status}, printed: {length: null}"
    assert rows(apply(target, f"id: D-1, {where}, held: {{length: 2}}")) == []
    assert target["messages"][0]["length"] == 2
    assert rows(apply(target, f"id: D-1, {where}, held: {{length: 3}}")) == [
        "4:59 ICD080 stale erratum D-1: it was written for `length: (absent)`, the ICD "
        "now has `length: 2` (errata.yaml:4:81)"
    ]


def test_a_changed_value_is_in_the_overlay_and_its_key_in_the_icd():
    target = tree()
    apply(
        target,
        "id: D-1, where: {message: Status, field: Voltage}, held: {unit: V, min: 3}",
    )
    field = target["messages"][0]["fields"][0]
    assert (field["unit"], field["min"]) == ("V", 3)
    places = [field.at("unit"), field.at("min"), field.key_at("unit")]
    assert [str(place) for place in places] == [
        "errata.yaml:4:70",
        "errata.yaml:4:78",
        "demo.yaml:11:39",
    ]
    # The ICD does not have the key `min`, so its place is that of the field.
    assert field.key_at("min") == field.place


def test_null_removes_a_key():
    target = tree()
    apply(
        target,
        "id: D-1, where: {message: Status, field: Voltage}, held: {unit: null, min: null}",
    )
    field = target["messages"][0]["fields"][0]
    assert field == {"name": "Voltage", "bits": 8}
    assert str(field.at("unit")) == "demo.yaml:11:45"


def test_later_entries_name_what_earlier_entries_have_renamed():
    target = tree()
    applied = apply(
        target,
        "id: D-1, where: {message: Status}, held: {name: Power}",
        "id: D-2, where: {message: Power}, held: {mark: 1}",
        "id: D-3, where: {message: Status}, held: {mark: 2}",
        "id: D-4, where: {message: State, field: Voltage}, held: {unit: V}",
        "id: D-5, where: {message: State}, held: {fields: [{name: Level}]}",
        "id: D-6, where: {message: State, field: Level}, held: {mark: 1}",
        "id: D-7, where: {message: State, field: Voltage}, held: {mark: 1}",
    )
    assert list(marked(target)) == [STATUS, f"{STATE}.fields.0"]
    assert rows(applied) == [
        "6:22 ICD081 there is no message `Status`",
        "10:22 ICD081 there is no field `Voltage` in message `State`",
    ]


def test_notes_are_about_the_values_before_entries_change_them():
    where = "where: {message: Status, field: Voltage}, printed: {bits: 8}"
    target = tree()
    applied = apply(
        target,
        f"id: D-1, {where}, held: {{bits: 16}}",
        notes=(f"id: N-1, {where}, what: Odd.",),
    )
    assert rows(applied) == []
    assert [erratum.id for erratum in applied.entries] == ["D-1"]
    assert [erratum.id for erratum in applied.notes] == ["N-1"]
    # Entries precede notes in the pages about the field.
    field = target["messages"][0]["fields"][0]
    assert [erratum.id for erratum in applied.about(field)] == ["D-1", "N-1"]
    assert applied.about(target["messages"][0]) == ()


def test_entries_and_notes_have_all_that_the_overlay_says():
    applied = apply(
        tree(),
        "id: D-1, title: Unit, where: {message: Status, field: Voltage}, "
        "printed: {unit: mV}, held: {unit: V}, why: Wrong., evidence: Table 1., "
        "confidence: likely, tables: [1, x, 3]",
        "id: D-2, where: {message: Status}, accept: [ICD024]",
        notes=("id: N-1, where: {message: Status}, what: Odd., why: Unused.",),
    )
    assert applied.entries[0] == Erratum(
        id="D-1",
        title="Unit",
        why="Wrong.",
        evidence="Table 1.",
        confidence="likely",
        tables=(1, 3),
        printed=(("unit", "mV"),),
        held=(("unit", "V"),),
        changes=True,
        is_note=False,
        source=applied.entries[0].source,
    )
    (note,) = applied.notes
    assert (note.why, note.is_note, note.changes, note.tables) == (
        "Odd.",
        True,
        False,
        (),
    )


def test_codes_are_accepted_at_each_place_with_the_printed_values():
    target = tree()
    applied = apply(
        target,
        "id: D-1, where: [{message: Status}, {message: State}, {enum: Mode}], "
        "printed: {acknowledge: null}, accept: [ICD024, ICD021]",
    )
    state, mode = target["messages"][1], target["enums"][0]
    assert [
        (code, place.column, owner is state, owner is mode)
        for code, place, owner in applied.accepts
    ] == [
        ("ICD024", 114, True, False),
        ("ICD021", 122, True, False),
        ("ICD024", 114, False, True),
        ("ICD021", 122, False, True),
    ]
    assert [finding.code for finding in applied.findings] == ["ICD080"]


def wildcard(fields: int, places: int | None) -> list[Finding]:
    """Return the findings of an entry for all of the fields of a message, each in a
    line of its own.
    """
    listed = "".join(f"      - {{name: F{n}, unit: mV}}\n" for n in range(fields))
    text = f"node: {{name: demo}}\nmessages:\n  - name: Status\n    fields:\n{listed}"
    stated = f", places: {places}" if places is not None else ""
    where = "where: {message: Status, field: '*'}, printed: {unit: mV}"
    entry = f"id: D-1, {where}, held: {{unit: V}}{stated}"
    return apply(parse(text.encode(), "demo.yaml"), entry).findings


def test_the_number_of_places_of_a_wildcard_is_exact():
    assert_limits(lambda places: not wildcard(3, places), least=3, most=3)
    (finding,) = wildcard(3, None)
    assert finding.message == "`printed` matches 3 places"
    assert finding.help == ("check lines 5, 6, 7 of demo.yaml, then write `places: 3`")
    assert str(finding.place) == "errata.yaml:4:22"
    (finding,) = wildcard(3, 2)
    assert finding.message == "`printed` matches 3 places, not 2"


def test_the_help_lists_at_most_six_lines_of_a_wildcard():
    (six,), (seven,) = wildcard(6, None), wildcard(7, None)
    assert six.help == (
        "check lines 5, 6, 7, 8, 9, 10 of demo.yaml, then write `places: 6`"
    )
    assert seven.help == (
        "check lines 5, 6, 7, 8, 9, 10, ... of demo.yaml, then write `places: 7`"
    )


def test_a_wildcard_without_a_place_is_reported_once_as_stale():
    target = tree()
    where = "where: {message: '*', field: Level}, printed: {unit: mV}"
    (finding,) = apply(target, f"id: D-1, {where}, held: {{mark: 1}}").findings
    assert (finding.code, finding.message) == ("ICD080", "`printed` matches 0 places")
    assert finding.help.startswith("compare with the manual: ")


def test_an_id_that_occurs_again_is_compared_with_the_first():
    entry = "id: D-1, where: {message: Status}, held: {mark: 1}"
    target = tree()
    applied = apply(target, entry, "id: D-2", entry, entry)
    assert rows(applied) == [
        "6:10 ICD082 the id `D-1` is used twice, first in line 4",
        "7:10 ICD082 the id `D-1` is used twice, first in line 4",
    ]


def test_entries_with_a_broken_mapping_at_any_depth_are_ignored():
    target = tree()
    overlaid = overlay(
        "id: D-1, where: [{message: Status}], held: {mark: 1}",
        "id: D-2, where: [{message: State}], held: {mark: 1}",
    )
    broken = {id(overlaid["entries"][0]["where"][0])}
    applied = errata.apply(target, overlaid, broken)
    assert list(marked(target)) == [STATE]
    assert [erratum.id for erratum in applied.entries] == ["D-2"]


def test_an_overlay_of_another_node_changes_nothing():
    target = tree()
    text = "errata: 1\nnode: Demo\nentries: [{id: D-1, where: {message: Status}, held: {mark: 1}}]\n"
    applied = errata.apply(target, parse(text.encode(), "errata.yaml"))
    assert rows(applied) == [
        "2:7 ICD083 this overlay is for node `Demo`, but lies beside `demo`"
    ]
    assert list(marked(target)) == [] and applied.entries == []
    assert errata.apply(target, None).findings == []

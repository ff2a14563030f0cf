"""Each erratum is listed once, and explained by the first part that has it."""

from __future__ import annotations

from types import SimpleNamespace

from icdgen.describe.errata import (
    errata_of_enum,
    errata_of_message,
    first_owners,
    owners_elsewhere,
)
from tests.icd.files import loaded


def erratum(id):
    return SimpleNamespace(id=id)


def part(name, *ids, **more):
    return SimpleNamespace(name=name, errata=tuple(map(erratum, ids)), **more)


def test_the_first_part_explains_an_erratum():
    first, second, third = part("A", "E1"), part("B", "E2", "E1"), part("C", "E2", "E3")
    owners = first_owners((first, second, third))
    assert owners == {"E1": first, "E2": second, "E3": third}
    assert owners_elsewhere(first, owners) == {}
    assert owners_elsewhere(second, owners) == {"E1": "A"}
    assert owners_elsewhere(third, owners) == {"E2": "B"}
    assert owners_elsewhere(part("D", "E9"), owners) == {}


def test_errata_of_an_enumeration_include_those_of_its_members():
    members = (part("One", "E2", "E1"), part("Two", "E3", "E2"))
    enum = part("Mode", "E1", members=members)
    assert [each.id for each in errata_of_enum(enum)] == ["E1", "E2", "E3"]


def test_errata_of_a_message_include_those_of_structs_and_inner_fields(tmp_path):
    text = """\
structs:
  - name: Point
    length: 1
    fields:
      - {at: 0, bits: 8, name: X, type: uint}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: A, type: uint}
      - {at: 8, name: P, struct: Point}
# errata/demo.yaml
errata: 1
node: demo
entries: []
notes:
"""
    places = (
        "{struct: Point, field: X}",
        "{message: Status, field: A}",
        "[{message: Status}, {message: Status, field: A}]",
    )
    for number, where in enumerate(places, 1):
        text += (
            f"  - {{id: DEMO-00{number}, title: Note, where: {where}, "
            "what: A fact., evidence: The manual.}\n"
        )
    result = loaded(tmp_path, text)
    assert result.ok, [finding.message for finding in result.findings]
    (message,) = result.icd.nodes[0].messages
    ids = [each.id for each in errata_of_message(message)]
    assert ids == ["DEMO-003", "DEMO-002", "DEMO-001"]

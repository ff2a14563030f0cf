"""The trace is true: if a line of an ICD is changed, exactly the vectors that the trace
lists fail.
"""

from __future__ import annotations

import csv
import io
import json
import random
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given, settings

from icdgen import backends
from icdgen.icd.layout import Layout
from icdgen.icd.model import Icd
from icdgen.icd.places import places_in
from icdgen.loading import load
from icdgen.render import Renderer
from icdgen.vectors.make import make_vectors
from icdgen.vectors.write import vector_file_text
from tests.assurance.failing import VectorCheck, Vectors
from tests.conformance.icds import SHIPPED
from tests.conformance.random_icds import written
from tests.conformance.strategies import icds
from tests.conftest import ROOT

EACH = 1  # number of changes of each kind that are tried on the shipped ICDs


class Pack:
    """The verification package of the ICDs of a folder, and their vectors."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.icd: Icd = load([folder]).icd
        backend = backends.get("assurance")
        self.files = {
            str(path): content
            for path, content in backend.files(self.icd, Renderer.of_backend(backend))
        }
        self.vectors = Vectors(
            {
                node.name: vector_file_text(make_vectors(self.icd, node))
                for node in self.icd.nodes
            }
        )
        self.trace, self.changes = self.table("trace.csv"), self.table("changes.csv")

    def table(self, name: str) -> list[dict[str, str]]:
        return list(csv.DictReader(io.StringIO(self.files[name], newline="")))

    def changed(self, change: dict[str, str], folder: Path) -> Icd:
        """Return the ICDs with one value of one line changed."""
        shutil.copytree(self.folder, folder)
        needed = {change["node"], *self.listed(change)}
        needed |= {
            node.name
            for name in needed
            for node in self.icd.included(self.icd.node(name))
        }
        for node in self.icd.nodes:  # reading them all takes a second each time
            if node.name not in needed:
                Path(node.file.replace(str(self.folder), str(folder), 1)).unlink()
        path = folder / change["file"]
        text = path.read_text("utf-8")
        # Offset of the value in the file, from its line and column.
        before = (
            sum(len(line) + 1 for line in text.split("\n")[: int(change["line"]) - 1])
            + int(change["column"])
            - 1
        )
        following = text[before:]
        if following.startswith("["):  # an id as several numbers, or points of a table
            end = next(
                end
                for end in range(1, len(following))
                if following[:end].count("[") == following[:end].count("]")
            )
        else:
            end = next(
                end
                for end in range(1, len(following) + 1)
                if _value(following[:end]) == change["says"]
            )
        now = (
            json.dumps(change["changed to"])
            if change["kind"] == "formula"
            else change["changed to"]
        )
        path.write_text(text[:before] + now + following[end:], "utf-8")
        return load([folder], check=False).icd

    def fields(self, message: str, node: str, icd: Icd | None = None) -> list[str]:
        """Return the names of the fields of a message."""
        messages = {each.name: each for each in (icd or self.icd).node(node).messages}
        return [field.name for field in messages[message].fields]

    def messages_of(self, change: dict[str, str]) -> list[str]:
        """Return the message that a change belongs to, or the messages that use its
        struct.
        """
        node, part = self.icd.node(change["node"]), change["part of"]
        holders = (
            m.name
            for m in node.messages
            if any(s.name == part for s in structs(m.layout))
        )
        return list(
            dict.fromkeys(
                [*(m.name for m in node.messages if m.name == part), *holders]
            )
        )

    def listed(self, change: dict[str, str]) -> dict[str, set[int]]:
        return numbers_by_node(change["vectors"])


def structs(layout: Layout) -> Iterator[Layout]:
    """Yield the layouts of the structs of a message or a struct, including nested ones."""
    for place in places_in(layout):
        if place.struct is not None:
            yield place.struct
            yield from structs(place.struct)


def _value(text: str) -> str:
    """Return a scalar of YAML or JSON as a table shows it.

    Numbers are shown as Python prints them, texts without quotes.
    """
    text = text.strip()
    if text[:1] == "'":
        return text[1:-1] if len(text) > 1 and text[-1] == "'" else ""
    try:
        if (
            text[:1] == '"'
        ):  # names in formulas of derived values have what must be escaped
            return str(json.loads(text))
        return str(int(text, 0) if text.lower().startswith("0x") else text)
    except ValueError:
        return "" if text[:1] == '"' else text


def numbers_by_node(cell: str) -> dict[str, set[int]]:
    """Return ``demo.json 3-5 7; other.json 1`` as numbers by node."""
    by_node: dict[str, set[int]] = {}
    for part in filter(None, cell.split("; ")):
        file, *runs = part.split(" ")
        numbers = by_node.setdefault(file.removesuffix(".json"), set())
        for run in runs:
            first, _, last = run.partition("-")
            numbers |= set(range(int(first), int(last or first) + 1))
    return by_node


@pytest.fixture(scope="module")
def shipped() -> Pack:
    return Pack(SHIPPED)


@pytest.fixture(scope="module")
def demo_pack(tmp_path_factory) -> Pack:
    from tests.conftest import DEMO

    folder = tmp_path_factory.mktemp("icd")
    (folder / "demo.yaml").write_text(DEMO, "utf-8")
    return Pack(folder)


def assert_listed_vectors_fail(
    pack: Pack, change: dict[str, str], folder: Path
) -> None:
    """Check that every vector that the trace lists fails, and no other vector of the
    frames of the changed message.
    """
    changed, listed = pack.changed(change, folder), pack.listed(change)
    vector_check = VectorCheck(pack.vectors, changed)
    for node, numbers in listed.items():
        about = (
            [*pack.vectors.of_node(node)]
            if min(numbers) < pack.vectors.first_message(node)
            else []
        )
        for name in pack.vectors.messages_at(node, numbers):
            about += pack.vectors.of_message(node, name)
        failing = vector_check.failing(
            (number, cases) for number, cases in about if number in numbers
        )
        assert numbers == failing, (change, node, sorted(numbers - failing))
    if change["kind"] not in ("enum value", "id", "length", "node"):
        node = change["node"]
        for message in pack.messages_of(change):
            if pack.fields(message, node) != pack.fields(message, node, changed):
                # The change adds or removes elements or parts of a split field: all frames
                # are decoded to other names.
                continue
            vectors_of_message = pack.vectors.of_message(node, message)
            # A value that physical values cannot restore is tested with another frame than
            # that of the row. These cases have no fixed bytes and are left out.
            unlisted = [
                (
                    number,
                    [case for case in cases if case.answer.get("bytes") is not ...],
                )
                for number, cases in vectors_of_message
                if is_row(cases) and number not in listed.get(node, ())
            ]
            assert vector_check.failing(unlisted) == set(), change


def is_row(cases: list) -> bool:
    return bool(cases) and cases[0].request["op"] == "decode" and cases[0].answer["ok"]


def test_each_change_of_a_small_icd_fails_the_vectors_that_the_trace_names(
    demo_pack, tmp_path
):
    assert {change["kind"] for change in demo_pack.changes} >= {
        "offset",
        "width",
        "type",
        "formula",
        "id",
        "length",
        "enum value",
    }
    for number, change in enumerate(demo_pack.changes):
        assert change["vectors"], change
        assert_listed_vectors_fail(demo_pack, change, tmp_path / str(number))


NAMED = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
enums:
  - name: Mode
    members: [{value: 5, name: A}, {value: 0, to: 4, name: B}, {value: 8, to: 9, name: C}, {value: 10, name: D}]
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 5
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 8, bits: 32, name: Level, type: float, special: [{value: nan, meaning: not known}, {value: -99.9, meaning: no data}]}
"""


def test_each_change_of_a_range_or_of_a_special_value_fails_the_vectors_that_the_trace_names(
    tmp_path,
):
    (tmp_path / "icd").mkdir()
    (tmp_path / "icd" / "demo.yaml").write_text(NAMED, "utf-8")
    pack = Pack(tmp_path / "icd")
    named = [
        change for change in pack.changes if change["kind"] in ("enum value", "special")
    ]
    assert len(named) == 14
    for number, change in enumerate(named):
        assert change["vectors"], change
        assert_listed_vectors_fail(pack, change, tmp_path / str(number))


DERIVED = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: A "quoted" one, type: uint}
      - {at: 8, bits: 1, name: Flag, type: bool}
      - {at: 9, bits: 7, name: Level, type: uint, when: {Flag: 1}}
      - {at: 24, bits: 16, name: Levels, type: uint, count: rest, up_to: 2}
    derived:
      - {name: Triple, formula: 'A "quoted" one*3'}
      - {name: Power, formula: 'Triple*A "quoted" one'}
"""


def test_each_change_of_a_derived_value_and_of_a_condition_fails_the_vectors_that_the_trace_names(
    tmp_path,
):
    (tmp_path / "icd").mkdir()
    (tmp_path / "icd" / "demo.yaml").write_text(DERIVED, "utf-8")
    pack = Pack(tmp_path / "icd")
    changes = [
        change
        for change in pack.changes
        if change["key"] == "formula" or change["kind"] == "condition"
    ]
    assert [
        change["changed to"] for change in changes if change["kind"] == "condition"
    ] == ["0"]
    assert {change["name"] for change in changes} == {"Triple", "Power", "Level"}
    for number, change in enumerate(changes):
        assert change["vectors"], change
        assert_listed_vectors_fail(pack, change, tmp_path / str(number))


OVERLAPPING = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: msb0}
structs:
  - {name: Pair, length: 4, fields: [{at: 0, bits: 7, name: Levels, type: int, count: 3}, {at: 21, bits: 5, name: Rest, type: int}]}
messages:
  - {name: Status, id: 130, kind: telemetry, length: 4, fields: [{at: 0, name: Both, struct: Pair}]}
"""


def test_changes_of_elements_that_then_overlap_fail_the_vectors_that_the_trace_names(
    tmp_path,
):
    (tmp_path / "icd").mkdir()
    (tmp_path / "icd" / "demo.yaml").write_text(OVERLAPPING, "utf-8")
    pack = Pack(tmp_path / "icd")
    assert {"offset", "width", "count", "type"} <= {
        change["kind"] for change in pack.changes
    }
    for number, change in enumerate(pack.changes):
        assert change["vectors"], change
        assert_listed_vectors_fail(pack, change, tmp_path / str(number))


def test_changed_lines_of_the_shipped_icds_fail_the_vectors_that_the_trace_names(
    shipped, tmp_path
):
    decided = {
        (e["node"], e["touches"])
        for e in shipped.table("errata.csv")
        if e["kind"] == "Erratum"
    }
    touched = {(node, line) for node, lines in decided for line in lines.split("; ")}
    source = random.Random(13)
    # A change takes seconds, because the ICDs are loaded again: only some of each kind
    # are tried.
    for kind in sorted({change["kind"] for change in shipped.changes}):
        # An erratum that refers to the printed value of a line would no longer apply.
        free = [
            c
            for c in shipped.changes
            if c["kind"] == kind
            and (c["node"], f"{c['file']}:{c['line']}") not in touched
        ]
        for number, change in enumerate(source.sample(free, min(EACH, len(free)))):
            assert_listed_vectors_fail(shipped, change, tmp_path / f"{kind}{number}")


@settings(max_examples=2)
@given(icds())
def test_changed_lines_of_any_icd_fail_the_vectors_that_the_trace_names(
    tmp_path_factory, trees
):
    folder = tmp_path_factory.mktemp("random")
    (folder / "icd").mkdir()
    written(trees, folder / "icd")
    pack = Pack(folder / "icd")
    chosen = random.Random(1).sample(pack.changes, min(10, len(pack.changes)))
    for number, change in enumerate(chosen):
        assert_listed_vectors_fail(pack, change, folder / str(number))


def test_every_change_of_the_shipped_icds_is_detected(shipped):
    assert len(shipped.changes) > 10_000
    assert [row["name"] for row in shipped.trace if row["unnoticed"] != "0"] == []


def test_every_message_field_and_member_is_traced_to_its_line_and_its_symbols(shipped):
    rows = {
        (row["kind"], row["node"], row["part of"], row["name"]): row
        for row in shipped.trace
    }
    for node in shipped.icd.nodes:
        for message in node.messages:
            row = rows["message", node.name, "", message.name]
            assert (
                row["table"] == str(message.table or "")
                and row["C"]
                and row["Python"]
                and row["Rust"]
            )
            for field in message.fields:
                row = rows["field", node.name, message.name, field.name]
                line = (
                    (ROOT / "icd" / row["file"])
                    .read_text("utf-8")
                    .split("\n")[int(row["line"]) - 1]
                )
                assert field.name in line and row["C"] and row["Python"] and row["Rust"]


def test_the_symbols_of_a_line_stand_in_the_generated_code(shipped):
    texts = {
        language: "\n".join(
            path.read_text("utf-8")
            for path in (ROOT / "generated" / language).rglob("*")
            if path.suffix == suffix
        )
        for language, suffix in (("c", ".h"), ("python", ".py"), ("rust", ".rs"))
    }
    rows = [
        row for row in shipped.trace if row["kind"] in ("field", "member", "message")
    ]
    for row in random.Random(5).sample(rows, 300):
        for language, column in (("c", "C"), ("python", "Python"), ("rust", "Rust")):
            for symbol in row[column].split("; "):
                name, _, scope = symbol.partition(" (")
                assert (
                    "file" in scope.lower() and "scope" not in scope
                ) or name in texts[language], (
                    row["name"],
                    symbol,
                )


def test_the_pack_is_the_same_each_time(demo_pack, tmp_path):
    repeated = Pack(demo_pack.folder)
    elsewhere = tmp_path / "elsewhere"
    shutil.copytree(demo_pack.folder, elsewhere)
    assert repeated.files == demo_pack.files == Pack(elsewhere).files


TWO_PARTS = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Keys Count, type: uint}
      - {at: 8, bits: 8, name: Levels Count, type: uint}
      - {at: 16, bits: 16, name: Keys, type: uint, count: Keys Count, up_to: 3}
      - {at: 16, after: Keys, bits: 16, name: Levels, type: int, formula: raw*0.5, count: Levels Count, up_to: 2}
"""


def test_each_change_of_elements_behind_a_variable_part_fails_the_vectors_that_the_trace_names(
    tmp_path,
):
    (tmp_path / "icd").mkdir()
    (tmp_path / "icd" / "demo.yaml").write_text(TWO_PARTS, "utf-8")
    pack = Pack(tmp_path / "icd")
    behind = [change for change in pack.changes if change["name"] == "Levels"]
    assert {change["kind"] for change in behind} == {"type", "formula"}
    for number, change in enumerate(behind):
        assert change["vectors"], change
        assert_listed_vectors_fail(pack, change, tmp_path / str(number))


WITHIN = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: msb0}
structs:
  - {name: Cell, length: 1, fields: [{at: 0, bits: 8, name: Charge, type: uint}]}
  - {name: Pack, length: 3, fields: [{at: 0, name: Cells, struct: Cell, count: 2}]}
messages:
  - {name: Status, id: 130, kind: telemetry, length: 3, fields: [{at: 0, name: Main, struct: Pack}]}
"""


def test_changes_of_a_struct_within_another_struct_are_detected(tmp_path):
    (tmp_path / "demo.yaml").write_text(WITHIN, "utf-8")
    changes = Pack(tmp_path).changes
    assert {change["name"] for change in changes} >= {"Cells", "Charge"}
    assert [change["name"] for change in changes if not change["vectors"]] == []

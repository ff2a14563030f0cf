"""Identifiers that languages declare, without those of lines with an error."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from icdgen.icd import rules
from icdgen.icd.fault import Fault
from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import Icd
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.declarations import declared_identifiers
from tests.icd.files import loaded


class Names:
    """Language with one identifier for each node, message, struct and field."""

    def __init__(self, title: str = "Names") -> None:
        self.name, self.title, self.reserved = title.lower(), title, frozenset({"if"})
        self.calls = 0

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        self.calls += 1
        yield Identifier("", "runtime", "", None)
        for node in icd.nodes:
            yield Identifier("", node.name, "", node.source)
            for owner in (*node.messages, *node.structs):
                yield Identifier("", owner.name, "", owner.source)
                for line in owner.layout.nodes:
                    yield Identifier(owner.name, line.name, "", line.source)


ICD = """\
structs:
  - {name: Pair, length: 1, fields: [{at: 0, bits: 8, name: S, type: uint}]}
messages:
  - {name: One, id: 1, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: A, type: uint}]}
  - {name: Two, id: 2, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: A, type: uint}]}
"""


@pytest.fixture
def ctx(tmp_path) -> Context:
    return Context(loaded(tmp_path, ICD).icd, languages=[Names(), Names("Others")])


def texts(ctx: Context) -> list[str]:
    return [each.text for each in declared_identifiers(ctx)[0].identifiers]


def fault(ctx: Context, code: str, *, message: int, of_field: bool = False) -> None:
    """Add a fault of a message or of its field to those that are reported."""
    found = ctx.icd.nodes[0].messages[message]
    source = found.layout.nodes[0].source if of_field else found.source
    ctx.raised.append((code, Fault(source, source.place, "")))


ALL = ["runtime", "demo", "One", "A", "Two", "A", "Pair", "S"]


def test_each_language_is_asked_once(ctx):
    first, second = declared_identifiers(ctx)
    assert declared_identifiers(ctx) == [first, second]
    assert [each.calls for each in ctx.languages] == [1, 1]
    assert (first.language, second.language) == ("Names", "Others")
    assert first.reserved == {"if"}
    assert texts(ctx) == ALL
    assert first.texts["A"] == 2 and first.texts["One"] == 1
    assert [each.scope for each in first.spelled({"A", "B"})] == ["One", "Two"]
    assert first.spelled(set()) == []


@pytest.mark.parametrize(
    ("code", "of_field", "left"),
    [
        ("ICD031", True, ["runtime", "demo", "One", "A", "Two", "Pair", "S"]),
        # The name of a message with another error is compared, and so are its fields.
        ("ICD024", False, ALL),
        # A warning does not make a line wrong.
        ("ICD066", True, ALL),
        *(
            (code, False, ["runtime", "demo", "One", "A", "Pair", "S"])
            for code in (
                "ICD050",
                "ICD051",
                "ICD052",
                "ICD053",
                "ICD054",
                "ICD057",
                "ICD049",
            )
        ),
    ],
)
def test_lines_with_an_error_are_left_out(ctx, code, of_field, left):
    assert code in rules.ALL
    fault(ctx, code, message=1, of_field=of_field)
    assert texts(ctx) == left


def test_of_nodes_with_one_name_only_the_first_is_compared(tmp_path):
    head = "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\n"
    text = f"{ICD}# other.yaml\n{head}{ICD.replace('One', 'Three')}"
    ctx = Context(loaded(tmp_path, text).icd, languages=[Names()])
    assert len(ctx.icd.nodes) == 2
    assert texts(ctx) == ALL


def test_an_icd_without_nodes_declares_nothing():
    ctx = Context(Icd(()), languages=[Names()])
    assert declared_identifiers(ctx) == []

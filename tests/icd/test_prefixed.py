"""A prefix is before the names of nodes at all places, and nowhere else."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from functools import cache

from icdgen.icd.model import Icd
from icdgen.icd.prefixed import with_prefix
from tests.conformance import ROOT
from tests.conformance.icds import read_unchecked

PREFIX = "vendor_"


@cache
def odd() -> Icd:
    """Return ICDs that have all kinds of nodes."""
    return read_unchecked(ROOT / "tests" / "conformance" / "odd_icds")


def values(
    part: object, path: str = "", seen: set[int] | None = None
) -> Iterator[tuple[str, object]]:
    """Yield (path, value) for each value of a model that has no parts."""
    seen = set() if seen is None else seen
    if isinstance(part, tuple):
        for number, item in enumerate(part):
            yield from values(item, f"{path}[{number}]", seen)
    elif is_dataclass(part):
        if id(part) in seen:
            return
        seen.add(id(part))
        for field in fields(part):
            if field.compare:
                name = f"{type(part).__name__}.{field.name}"
                yield from values(getattr(part, field.name), f"{path}/{name}", seen)
    else:
        yield path, part


NAMES_OF_NODES = (
    "/Node.name",
    "/Message.node",
    "/Struct.node",
    "/Enum.node",
    "/Layout.owner",
)


def is_name_of_node(path: str) -> bool:
    return path.endswith(NAMES_OF_NODES) or "/Node.includes[" in path


def test_all_names_of_nodes_have_the_prefix_and_no_other_value_differs():
    before = dict(values(odd()))
    after = dict(values(with_prefix(odd(), PREFIX)))
    assert before.keys() == after.keys()
    names = [path for path in before if is_name_of_node(path)]
    for suffix in NAMES_OF_NODES:
        assert any(path.endswith(suffix) for path in names), suffix
    assert any("includes" in path for path in names)
    expected = {
        path: PREFIX + value if is_name_of_node(path) else value
        for path, value in before.items()
    }
    assert after == expected


def test_enumerations_and_structs_stay_shared():
    """Generated code has one type for all fields of an enumeration."""

    def identities(icd: Icd) -> list[list[int]]:
        """Return which scalars have the same enumeration, by its first place."""
        rows = []
        for node in icd.nodes:
            own = {id(enum): number for number, enum in enumerate(node.enums)}
            rows.append([
                own.get(id(field.scalar.enum), -1)
                for message in node.messages
                for field in message.fields
            ])  # fmt: skip
        return rows

    before = identities(odd())
    assert any(number >= 0 for row in before for number in row)
    assert identities(with_prefix(odd(), PREFIX)) == before


def test_an_empty_prefix_needs_no_copy():
    assert with_prefix(odd(), "") is odd()

"""A field can have a role for the same reasons in a file and in a layout."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from icdgen.icd import roles
from icdgen.icd.layout import LayoutNode
from icdgen.icd.roles import reasons_against
from icdgen.icd.source import parse
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT
from tests.icd.test_layout import SETS
from tests.limits import assert_limits

GENERAL = {
    name: role
    for name, role in vars(roles).items()
    if isinstance(role, roles.Role) and name[0] != "_"
}


def nodes_of(path: str) -> list[LayoutNode]:
    """Yield the nodes of all messages and structs that are a complete line of a file."""
    icd = read_unchecked(ROOT / path)
    owners = [owner for node in icd.nodes for owner in (*node.messages, *node.structs)]
    return [
        node
        for owner in owners
        for node in owner.layout.fixed
        if any(item is node.source for item in owner.source["fields"])
    ]


@pytest.mark.parametrize("path", SETS)
@pytest.mark.parametrize("name", GENERAL)
def test_a_line_and_its_node_have_the_same_reasons_against_a_role(path, name):
    for node in nodes_of(path):
        assert reasons_against(node.source, GENERAL[name]) == reasons_against(
            node, GENERAL[name]
        ), node.name


def test_the_table_names_only_existing_features():
    every = [*GENERAL.values(), *roles.PROTOCOL.values()]
    assert all(
        set(role.excluded) <= set(roles.FEATURES) and role.types for role in every
    )


@pytest.mark.parametrize(
    ("line", "role", "reasons"),
    [
        ({"type": "uint", "bits": 8}, roles.COUNTER, []),
        (
            {"type": "int", "bits": 8, "formula": "raw*2"},
            roles.COUNTER,
            ["is scaled", "is `int`, not `uint`"],
        ),
        (
            {"type": "uint", "bits": 8, "when": {"Mode": 1}},
            roles.COUNTER,
            ["is optional"],
        ),
        ({"struct": "Channel"}, roles.COUNTER, ["is a struct"]),
        (
            {"type": "float", "bits": 32},
            roles.CONDITION,
            ["is `float`, not `uint`, `int`, `enum` or `bool`"],
        ),
        (
            {"type": "uint", "bits": 8, "view": True},
            roles.CONDITION,
            ["is an overlay field"],
        ),
        (
            {"type": "uint", "bits": 17},
            roles.EXPONENT,
            ["has 17 bits, but can have 16 at most"],
        ),
        (
            {"type": "bool", "bits": 1},
            roles.PROTOCOL["period"],
            ["has 1 bit, but needs 8 at least"],
        ),
        (
            {"type": "uint", "bits": 8},
            roles.PROTOCOL["mask"],
            ["is `uint`, not `bytes` or `text`"],
        ),
    ],
)
def test_each_reason_is_the_end_of_a_sentence(line, role, reasons):
    assert reasons_against(line, role) == reasons


def test_limits_of_the_width_of_a_field_with_a_role():
    def is_accepted(role: roles.Role, type: str = "uint") -> Callable[[int], bool]:
        return lambda bits: not reasons_against({"type": type, "bits": bits}, role)

    assert_limits(is_accepted(roles.SPLIT), most=64)
    assert_limits(is_accepted(roles.EXPONENT, "int"), most=16)
    assert_limits(is_accepted(roles.PROTOCOL["period"]), least=8)


@pytest.mark.parametrize(
    ("key", "feature"),
    [
        ("when: {A: 1}", "is optional"),
        ("struct: A", "is a struct"),
        ("count: 2", "is an array"),
        ("size: 2", "has a variable length"),
        ("bitfields: []", "is a split field"),
        ("formula: raw", "is scaled"),
        ("points: []", "is scaled"),
        ("const: 0", "is constant"),
        ("view: true", "is an overlay field"),
        ("view: false", None),
    ],
)
def test_a_key_gives_a_field_a_feature(key, feature):
    line = parse(f"{{type: uint, bits: 8, {key}}}".encode(), "demo.yaml")
    assert reasons_against(line, roles.COUNTER) == ([] if feature is None else [feature])  # fmt: skip

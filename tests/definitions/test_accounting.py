"""The import reports exactly the parts of its source that a reader did not use, by name
and place.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import (
    Account,
    AccountedElement,
    AccountedObject,
    accounted,
    settle,
)
from icdgen.definitions.model import Definitions
from icdgen.icd import source
from icdgen.icd.located import Seq

DEVICE = b"""<device version="2">
  <field name="speed" unit="m/s" period="10">text</field>
  <field name="mode"/>
  <group><inner value="1"/></group>
  <history><author name="somebody"/></history>
</device>"""


def device(*ignored: str) -> tuple[Account, AccountedElement]:
    account = Account(frozenset(ignored))
    return account, safe_xml.parse("device.xml", DEVICE, account=account)


def unused(account: Account) -> list[tuple[str, int | None]]:
    to = Definitions("device.xml")
    account.report(to)
    assert all(
        (finding.code, finding.severity) == ("IMP085", "note") and finding.help
        for finding in to.import_findings
    )
    return [(finding.message, finding.spot.line) for finding in to.import_findings]


def test_unread_attributes_texts_and_elements_are_reported_with_their_line():
    account, root = device()
    assert root.get("version") == "2"
    assert [element.get("name") for element in root.iterfind("field")] == [
        "speed",
        "mode",
    ]
    assert root.find("group/inner").attrib["value"] == "1"
    account.elements(root)
    assert unused(account) == [
        ("`period` of `field` is not used (`speed`)", 2),
        ("`text` of `field` is not used (`speed`)", 2),
        ("`unit` of `field` is not used (`speed`)", 2),
        ("`history` of `device` is not used", 5),
    ]


def test_iterating_over_children_does_not_count_as_reading():
    account, root = device("version", "device.history")
    assert [child.tag for child in root] == ["field", "field", "group", "history"]
    account.elements(root)
    assert unused(account) == [
        ("`field` of `device` is not used (2 times, first: `speed`)", 2),
        ("`group` of `device` is not used", 4),
    ]


def test_names_in_a_finding_are_not_reported_as_unused():
    account, root = device("version")
    for element in root:
        element.settle()
    account.elements(root)
    assert unused(account) == []


@pytest.mark.parametrize("access", ["items", "attrib", "iter", "itertext", "findtext"])
def test_each_way_to_read_counts(access):
    account, root = device("version", "history", "group")
    for field in root.iter("field"):
        if access == "items":
            assert dict(field.items())
        elif access == "attrib":
            assert dict(field.attrib)
    if access == "itertext":
        assert "text" in "".join(root.itertext())
    if access == "findtext":
        assert root.findtext("field") == "text"
    account.elements(root)
    keys = {message.split("`")[1] for message, _ in unused(account)}
    assert (
        keys
        == {
            "items": {"text"},
            "attrib": {"text"},
            "iter": {"name", "unit", "period", "text"},
            "itertext": {"name", "unit", "period", "value"},
            "findtext": {"name", "unit", "period"},
        }[access]
    )


def test_unread_keys_of_json_and_yaml_are_reported_with_their_path():
    tree = accounted(
        {
            "meta": {"id": "a", "license": "b"},
            "types": {"point": {"seq": [{"id": "x", "doc": "y"}], "doc": "z"}},
        },
        frozenset({"types"}),
    )
    assert (
        tree["meta"]["id"] == "a"
        and {**tree["types"]["point"]["seq"][0]}
        and "none" not in tree
    )
    account = Account()
    account.mappings(tree)
    assert unused(account) == [
        ("`license` of `meta` is not used (meta)", None),
        ("`doc` of `types` is not used (types.point)", None),
    ]


@pytest.mark.parametrize(
    ("access", "read"),
    [
        (lambda tree: tree["a"], {"a"}),
        (lambda tree: tree.get("b"), {"b"}),
        (lambda tree: "a" in tree, {"a"}),
        (lambda tree: "z" not in tree, set()),
        (lambda tree: list(tree.items()) == [("a", 1), ("b", 2)], {"a", "b"}),
        (lambda tree: list(tree.values()) == [1, 2], {"a", "b"}),
        (lambda tree: {**tree} == {"a": 1, "b": 2}, {"a", "b"}),
        (lambda tree: list(tree) == ["a", "b"], set()),
        (lambda tree: len(tree) == 2, set()),
    ],
)
def test_a_key_counts_as_read_if_its_value_was(access, read):
    tree = accounted({"a": 1, "b": 2})
    assert access(tree)
    account = Account()
    account.mappings(tree)
    keys = {message.split("`")[1] for message, _ in unused(account)}
    assert keys == {"a", "b"} - read


def test_unread_keys_of_yaml_are_reported_with_their_line():
    text = b"types:\n  - id: a\n    doc: b\n  - id: c\n    doc: d\nmeta: {}\n"
    tree = accounted(source.parse(text, "a.ksy"))
    types = tree["types"]
    assert isinstance(types, Seq) and [each["id"] for each in types] == ["a", "c"]
    account = Account()
    account.mappings(tree)
    assert unused(account) == [
        ("`doc` of `types` is not used (2 times, first: types[0])", 3),
        ("`meta` is not used", 6),
    ]


def test_elements_and_attributes_of_a_namespace_are_reported_without_it():
    data = b"""<a xmlns="urn:x" xmlns:n="urn:y"><b n:c="1" d="2"/><e/></a>"""
    account = Account()
    root = safe_xml.parse("a.xml", data, account=account)
    (child, _) = root
    assert child.get("d") == "2"
    account.elements(root)
    assert unused(account) == [
        ("`e` of `a` is not used", 1),
        ("`c` of `b` is not used", 1),
    ]


def test_parts_that_another_finding_names_are_not_reported_as_unused():
    tree = accounted({"a": {"b": [{"c": 1}]}, "d": {"e": 1}, "f": [{"g": 1}]})
    assert tree["a"] and tree["d"] and tree["f"]
    settle(tree["a"])
    settle(1)
    account = Account()
    account.mappings(tree)
    assert unused(account) == [
        ("`e` of `d` is not used (d)", None),
        ("`g` of `f` is not used (f[0])", None),
    ]


class Signal:
    """Object of a library."""

    name, unit, empty, missing, is_float = "Speed", "rpm", "", None, False
    zero, choices, _private = 0, {1: "on"}, "private"

    def decode(self) -> None:
        """Do nothing."""


def test_attributes_of_an_object_that_have_a_value_and_were_not_read_are_reported():
    account, signal = Account(), AccountedObject(Signal())
    assert signal.name == "Speed"
    account.attributes(signal, "signal", "`Speed`")
    assert unused(account) == [
        ("`choices` of `signal` is not used (`Speed`)", None),
        ("`unit` of `signal` is not used (`Speed`)", None),
        ("`zero` of `signal` is not used (`Speed`)", None),
    ]
    signal.settle()
    account = Account()
    account.attributes(signal, "signal", "`Speed`")
    assert unused(account) == []


def test_an_xml_that_nests_deeper_than_python_does_is_accounted_for():
    account = Account()
    root = safe_xml.parse(
        "deep.xml", b"<a>" * 20_000 + b"</a>" * 20_000, account=account
    )
    list(root.iter("a"))[-1].get("name")
    account.elements(root)
    assert unused(account) == []

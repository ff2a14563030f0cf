"""Names that cannot be, or that clash, are found before anything is generated."""

from __future__ import annotations

import json

import pytest

from icdgen.backends.python import PythonBackend
from icdgen.loading import load


def node(**keys) -> dict:
    head = {
        "name": "demo",
        "title": "Demo",
        "byte_order": "little",
        "bit_order": "lsb0",
        **keys.pop("node", {}),
    }
    return {"icdgen": 1, "node": head, **keys}


def message(
    *names: str, name: str = "Some", id: int = 1, unit: str = "", formula: str = ""
) -> dict:
    fields = [
        {"at": 8 * at, "bits": 8, "name": one, "type": "uint"}
        for at, one in enumerate(names)
    ]
    if formula:
        fields[0] |= {"formula": formula, "unit": unit}
    return {
        "name": name,
        "kind": "telemetry",
        "id": id,
        "length": len(fields),
        "fields": fields,
    }


def clashes(tmp_path, tree) -> list[tuple[str, str]]:
    """What the backend declares twice in a scope, and who does."""
    path = tmp_path / "demo.yaml"
    path.write_text(json.dumps(tree), encoding="utf-8")
    icd = load([path], check=False).icd
    seen: dict[tuple[str, str], str] = {}
    found = []
    for one in PythonBackend().identifiers(icd):
        if (one.scope, one.text) in seen:
            found.append((seen[one.scope, one.text], one.owner))
        seen[one.scope, one.text] = one.owner
    return found


@pytest.mark.parametrize(
    "name",
    [
        "To Bytes",
        "from bytes",
        "AsDict",
        "decode many",
        "Decode Table",
        "from_physical",
        "from dict",
        "to JSON",
        "Int",
        "float",
        "bytes",
        "bool",
    ],
)
def test_fields_named_like_what_every_message_has_are_found(tmp_path, name):
    ((owner, other),) = clashes(tmp_path, node(messages=[message(name)]))
    assert owner == f"field `{name}` of `Some`"
    assert name.lower().replace(" ", "_").replace("asdict", "as_dict") in other


@pytest.mark.parametrize("name", ["Self", "cls", "str"])
def test_fields_that_would_break_the_class_are_found(tmp_path, name):
    assert len(clashes(tmp_path, node(messages=[message(name)]))) == 1


def test_a_physical_value_may_not_be_named_like_another_field(tmp_path):
    found = clashes(
        tmp_path,
        node(messages=[message("Roll", "Roll deg", formula="raw*2", unit="deg")]),
    )
    assert found == [("field `Roll` of `Some`", "field `Roll deg` of `Some`")]


def test_messages_and_enumerations_share_the_names_of_a_node(tmp_path):
    enums = [{"name": "SOME", "members": [{"value": 0, "name": "Zero"}]}]
    found = clashes(tmp_path, node(messages=[message("A")], enums=enums))
    assert {owner for pair in found for owner in pair} == {
        "message `Some`",
        "enumeration `SOME`",
    }


def test_a_node_may_not_be_named_like_what_the_package_uses(tmp_path):
    assert clashes(tmp_path, node(node={"name": "sorted"})) == [
        ("node `sorted`", "the function `sorted`")
    ]


def test_members_that_become_the_same_are_found(tmp_path):
    members = [{"value": 0, "name": "On/Off"}, {"value": 1, "name": "on off"}]
    found = clashes(tmp_path, node(enums=[{"name": "Mode", "members": members}]))
    assert found == [("member `On/Off` of `Mode`", "member `on off` of `Mode`")]


@pytest.mark.parametrize("word", ["class", "from", "None", "lambda", "async"])
def test_reserved_words_are_known(word):
    assert word in PythonBackend.reserved


def test_soft_keywords_are_good_names():
    assert not {"match", "case", "type", "print"} & PythonBackend.reserved

"""Invalid and clashing Python names are found before any file is generated."""

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
        {"at": 8 * index, "bits": 8, "name": field_name, "type": "uint"}
        for index, field_name in enumerate(names)
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
    """Owners of identifiers that the backend declares twice in one scope."""
    path = tmp_path / "demo.yaml"
    path.write_text(json.dumps(tree), encoding="utf-8")
    icd = load([path], check=False).icd
    seen: dict[tuple[str, str], str] = {}
    pairs = []
    for identifier in PythonBackend().identifiers(icd):
        if (identifier.scope, identifier.text) in seen:
            pairs.append((seen[identifier.scope, identifier.text], identifier.owner))
        seen[identifier.scope, identifier.text] = identifier.owner
    return pairs


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
def test_fields_named_like_methods_of_every_message_are_found(tmp_path, name):
    ((owner, other),) = clashes(tmp_path, node(messages=[message(name)]))
    assert owner == f"field `{name}` of `Some`"
    assert name.lower().replace(" ", "_").replace("asdict", "as_dict") in other


@pytest.mark.parametrize("name", ["Self", "cls", "str"])
def test_fields_that_would_break_the_class_are_found(tmp_path, name):
    assert len(clashes(tmp_path, node(messages=[message(name)]))) == 1


def test_a_physical_value_may_not_be_named_like_another_field(tmp_path):
    pairs = clashes(
        tmp_path,
        node(messages=[message("Roll", "Roll deg", formula="raw*2", unit="deg")]),
    )
    assert pairs == [("field `Roll` of `Some`", "field `Roll deg` of `Some`")]


def test_messages_and_enumerations_share_the_scope_of_a_node(tmp_path):
    enums = [{"name": "SOME", "members": [{"value": 0, "name": "Zero"}]}]
    pairs = clashes(tmp_path, node(messages=[message("A")], enums=enums))
    assert {owner for pair in pairs for owner in pair} == {
        "message `Some`",
        "enumeration `SOME`",
    }


def test_a_node_may_not_be_named_like_a_function_that_the_package_uses(tmp_path):
    assert clashes(tmp_path, node(node={"name": "sorted"})) == [
        ("node `sorted`", "the function `sorted`")
    ]


def test_members_with_the_same_python_name_are_found(tmp_path):
    members = [{"value": 0, "name": "On/Off"}, {"value": 1, "name": "on off"}]
    pairs = clashes(tmp_path, node(enums=[{"name": "Mode", "members": members}]))
    assert pairs == [("member `On/Off` of `Mode`", "member `on off` of `Mode`")]


@pytest.mark.parametrize("word", ["class", "from", "None", "lambda", "async"])
def test_keywords_are_reserved(word):
    assert word in PythonBackend.reserved


def test_soft_keywords_are_valid_names():
    assert not {"match", "case", "type", "print"} & PythonBackend.reserved

"""Invalid and clashing Python names are found before any file is generated."""

from __future__ import annotations

import json

import pytest

from icdgen.backends.python import PythonBackend
from icdgen.backends.python.names import (
    accessors_in_python,
    constant_name,
    import_path,
    module_name,
)
from icdgen.loading import load
from tests.describe.small import message_of, node_of
from tests.limits import assert_limits


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


def test_the_module_of_a_keyword_has_an_underscore(tmp_path):
    text = "messages: [{name: Pass, id: 1, kind: telemetry, length: 0}]"
    (keyword,) = node_of(tmp_path, text).messages
    assert module_name(keyword) == "pass_"
    assert import_path(keyword, "demo", "..") == "._types.pass_"
    assert import_path(keyword, "other", "..") == "..demo._types.pass_"
    assert constant_name("timeout_no_timeout") == "TIMEOUT_NO_TIMEOUT"


def test_the_module_of_a_name_of_more_than_200_characters_has_a_checksum(tmp_path):
    def module_of(name: str) -> str:
        text = f"messages: [{{name: {name}, id: 1, kind: telemetry, length: 0}}]"
        return module_name(*node_of(tmp_path, text).messages)

    assert_limits(lambda n: module_of("a" * n) == "a" * n, most=200)
    names = [module_of("a" * 200 + end) for end in "bc"]
    assert names[0] != names[1]
    assert all(name[:201] == "a" * 200 + "_" and len(name) == 209 for name in names)


def test_a_read_only_value_has_only_the_accessor_of_doubles(tmp_path):
    value = "bits: 8, type: uint, formula: raw*0.5, unit: V"
    message = message_of(
        tmp_path,
        f"at: 0, name: Own, {value}",
        f"at: 0, name: Seen, {value}, view: true",
        length=1,
    )
    (own,), (seen,) = message.members, message.read_only_members
    assert [accessor.name for accessor in accessors_in_python(own)] == [
        "own_v",
        "own_mv",
    ]
    assert [accessor.name for accessor in accessors_in_python(seen)] == ["seen_v"]

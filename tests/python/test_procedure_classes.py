"""Classes of procedures in generated Python have typed inputs and outputs."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.python.procedures import ProcedureClass
from icdgen.describe import describe
from icdgen.protocol.procedures import Input, Output
from tests.icd.files import loaded

ENUM = """\
enums:
  - name: Result
    members:
      - {value: 1, name: Good}
"""


@pytest.fixture
def description(tmp_path):
    result = loaded(tmp_path, ENUM)
    assert result.ok
    return describe(result.icd)


def an_input(name, **changes):
    plain = {
        "is_bytes": False, "is_flag": False, "enum": None, "most": 9, "values": (),
        "is_optional": False, "summary": "",
    }  # fmt: skip
    return Input(name=name, **{**plain, **changes})


def class_of(description, inputs=(), outputs=(), blocks=None):
    procedure = SimpleNamespace(
        name="read_out",
        summary="Read it",
        source={},
        inputs=tuple(inputs),
        outputs=tuple(outputs),
        blocks=blocks,
        entry=None,
        most_entries=0,
        numbers=[each for each in inputs if not each.is_bytes],
        content=next((each for each in inputs if each.is_bytes), None),
    )
    return ProcedureClass(description, description.nodes[0], procedure)


def blocks(sends):
    return SimpleNamespace(size=64, most=500, sends=sends)


def test_required_parameters_come_first_in_the_order_of_the_icd(description):
    (result,) = description.icd.nodes[0].enums
    read_out = class_of(
        description,
        [
            an_input("page", is_optional=True),
            an_input("verify", is_flag=True),
            an_input("mode", enum=result),
            an_input("data", is_bytes=True),
        ],
    )
    assert read_out.name == "ReadOut"
    assert read_out.parameters == [
        "verify: bool",
        "mode: Result",
        "data: bytes",
        "page: Optional[int] = None",
    ]
    assert read_out.arguments == [
        "_link.LINK",
        '"read_out"',
        '{"page": page, "verify": verify, "mode": mode}',
        "data=data",
    ]
    assert read_out.imports == ["from ._types.result import Result"]


def test_a_procedure_without_inputs_has_only_its_name(description):
    read_out = class_of(description)
    assert read_out.parameters == []
    assert read_out.arguments == ["_link.LINK", '"read_out"']
    assert not read_out.uses_optional
    assert read_out.docstring.strip().strip('"') == "Read it."


def test_the_size_of_blocks_is_a_keyword(description):
    read_out = class_of(description, blocks=blocks(sends=False))
    assert read_out.parameters == ["*", "block: Optional[int] = None"]
    assert read_out.arguments[-1] == "block=block"
    assert read_out.uses_optional


@pytest.mark.parametrize(
    ("inputs", "sends", "errors", "is_receiver"),
    [
        (0, None, "", False),
        (1, None, "Raise `RangeError` for inputs out of range.", False),
        (0, False, "Raise `RangeError` for inputs out of range.", True),
        (0, True, "Raise `RangeError` and `TooLongError` for inputs", False),
    ],
)
def test_the_docstring_has_blocks_and_errors(
    description, inputs, sends, errors, is_receiver
):
    rows = [an_input("page", most=7)] * inputs
    form = None if sends is None else blocks(sends)
    text = " ".join(class_of(description, rows, blocks=form).docstring.split())
    assert errors in text
    assert ("Raise" in text) == bool(errors)
    assert ("``page``: 0 to 7." in text) == bool(inputs)
    assert ("bytes of a block, 1 to 64" in text) == (form is not None)
    assert ("has the received bytes, at most 500." in text) == is_receiver


def test_outputs_are_converted_unless_they_are_integers(description):
    (result,) = description.icd.nodes[0].enums
    read_out = class_of(
        description,
        outputs=[
            Output("count", 3, None, False),
            Output("done", 4, None, True),
            Output("result", 5, result, False),
        ],
    )
    assert read_out.outputs == [
        ("count", "int", ""),
        ("done", "bool", "bool"),
        ("result", "Result", "Result"),
    ]
    assert read_out.uses_optional

"""Links in generated Python are expressions that state exactly their values."""

from __future__ import annotations

import pytest

from icdgen.backends.python.literals import expression
from icdgen.link_calls import Call, Commented, Verbatim


@pytest.mark.parametrize(
    "value",
    [
        0,
        -3,
        True,
        None,
        2.5,
        'it\'s "quoted"\n\\',
        "",
        (),
        (1,),
        (1, 2),
        ((1,), (2, 3)),
        {},
        {"a": 1, 2: (3,)},
        ({"a": 1},),
        b"\x00\xff",
        b"",
    ],
)
def test_an_expression_evaluates_to_its_value(value):
    assert eval(expression(value)) == value


def test_calls_and_mappings_have_an_item_per_line_and_tuples_none():
    call = Call(
        "wire.Link",
        (Verbatim("SETTINGS"), (1,)),
        {"rows": (Call("wire.Row", (b"\x01",), {}, True),), "names": {1: "a"}},
    )
    assert expression(call) == (
        "wire.Link(\n"
        "    SETTINGS,\n"
        "    (1,),\n"
        "    rows=(\n"
        '        wire.Row(bytes.fromhex("01")),\n'
        "    ),\n"
        "    names={\n"
        '        1: "a",\n'
        "    },\n"
        ")"
    )


def test_assumptions_are_comments_above_their_item():
    long = " ".join(["assumed"] * 14)
    call = Call("wire.Link", (), {"timeout": Commented(5, ("no value", long))}, False)
    lines = expression(call).splitlines()
    assert lines[0] == "wire.Link("
    assert lines[1] == "    # no value."
    assert lines[2].startswith("    # assumed assumed ")
    # A continued line is indented, so that no tool reads it as an instruction.
    assert [line[:8] for line in lines[3:-2]] == ["    #   "] * len(lines[3:-2])
    assert lines[3:-2] and all(len(line) <= 88 for line in lines)
    words = " ".join(line.split("#")[1].strip() for line in lines[2:-2])
    assert words == f"{long}."
    assert lines[-2:] == ["    timeout=5,", ")"]

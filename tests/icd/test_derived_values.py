"""Operands and exponents of derived values are fields that can have these roles."""

from __future__ import annotations

import pytest

from icdgen.icd.derived_values import derivation_of
from icdgen.icd.formula import FormulaError
from icdgen.icd.layout import Condition, Layout, Scalar, StructRef
from tests.limits import assert_limits


def scalar(name: str, type: str = "uint", bits: int = 8, **keys) -> Scalar:
    return Scalar(name=name, type=type, bits=bits, **keys)


NODES = (
    scalar("A"),
    scalar("Int", "int", 16),
    scalar("Float", "float", 32),
    scalar("Flag", "bool", 1),
    scalar("Octets", "bytes"),
    scalar("Sometimes", present_if=(Condition("A", (1,)),)),
    StructRef(name="Struct", layout=Layout("Struct", 1, (scalar("B"),))),
)


def reason(formula: str, nodes=NODES) -> str:
    """Return the message about a formula; empty if it can be computed."""
    try:
        derivation_of(formula, nodes)
    except FormulaError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        ("A + Int*Float", ""),
        ("A + Flag", "`Flag` is `bool`, not `uint`, `int` or `float`"),
        ("Octets + A", "`Octets` is `bytes`, not `uint`, `int` or `float`"),
        ("A/Sometimes", "`Sometimes` is optional"),
        ("Struct*2", "`Struct` is a struct"),
        ("A*Flag + Sometimes", "`Flag` is `bool`, not `uint`, `int` or `float`"),
    ],
)
def test_operands_are_numbers_of_each_frame(formula, message):
    assert reason(formula) == message


WANTED = "an exponent is a `uint` or `int` of up to 16 bits without a formula"


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        ("2^A", ""),
        ("Float^A", ""),
        ("A^2", ""),
        ("2^Int", ""),
        ("(A + 1)^A", ""),
        ("2^Float", "`Float` cannot be an exponent: it is `float`, not `uint` or `int`, and " + WANTED),
        ("A + A^Int*2^Float", "`Float` cannot be an exponent: it is `float`, not `uint` or `int`, and " + WANTED),
        ("Float*2", ""),
    ],
)  # fmt: skip
def test_exponents_are_small_whole_numbers(formula, message):
    assert reason(formula) == message


def test_an_exponent_has_up_to_16_bits():
    def nodes(bits: int) -> tuple[Scalar, ...]:
        return (scalar("A"), scalar("N", bits=bits))

    assert_limits(lambda bits: not reason("A^N", nodes(bits)), most=16)
    text = "`N` cannot be an exponent: it has 17 bits, but can have 16 at most, and "
    assert reason("A^N", nodes(17)) == text + WANTED


def test_a_name_of_no_node_is_no_operand():
    with pytest.raises(FormulaError, match="there is no field"):
        derivation_of("A + Missing", NODES)
    assert derivation_of("A + A*Int", iter(NODES)).fields == ("A", "Int")

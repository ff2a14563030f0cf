"""Derived values of a layout: parses their formulas and checks the operands."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.icd import derived
from icdgen.icd.derived import Derivation
from icdgen.icd.formula import FormulaError
from icdgen.icd.layout import LayoutNode
from icdgen.icd.roles import EXPONENT, OPERAND, reasons_against


def derivation_of(text: str, nodes: Iterable[LayoutNode]) -> Derivation:
    """Return the derivation of a formula over nodes of a layout.

    Raises `icdgen.icd.formula.FormulaError`.
    """
    nodes = list(nodes)
    derivation = derived.parse(text, {node.name for node in nodes})
    check_operands(derivation, nodes)
    return derivation


def check_operands(derivation: Derivation, nodes: Iterable[LayoutNode]) -> None:
    """Raise `icdgen.icd.formula.FormulaError` if a node cannot be an operand or an
    exponent, or is declared later.
    """
    by_name = {node.name: node for node in nodes}
    for name in derivation.fields:
        if name not in by_name:
            raise FormulaError(f"`{name}` is not derived before it")
        if reasons := reasons_against(by_name[name], OPERAND):
            raise FormulaError(f"`{name}` {reasons[0]}")
    for step in derivation.steps:
        if step.operator == "^" and step.right < len(derivation.fields):
            name = derivation.fields[step.right]
            if reasons := reasons_against(by_name[name], EXPONENT):
                wanted = f"an exponent is a `uint` or `int` of up to {EXPONENT.most_bits} bits without a formula"
                raise FormulaError(
                    f"`{name}` cannot be an exponent: it {reasons[0]}, and {wanted}"
                )

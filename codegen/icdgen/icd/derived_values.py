"""Derived values of a layout: which of its nodes a formula may use."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.icd import derived
from icdgen.icd.derived import Derivation
from icdgen.icd.formula import FormulaError
from icdgen.icd.layout import Array, LayoutNode, scalar_of

EXPONENT_BITS = 16
"""The widest field that may stand behind `^`."""


def derivation_of(text: str, nodes: Iterable[LayoutNode]) -> Derivation:
    """Return the derivation of a formula over nodes of a layout. Raises `icdgen.icd.formula.FormulaError`."""
    nodes = list(nodes)
    derivation = derived.parse(text, {node.name for node in nodes})
    check_operands(derivation, nodes)
    return derivation


def check_operands(derivation: Derivation, nodes: Iterable[LayoutNode]) -> None:
    """Raise `icdgen.icd.formula.FormulaError` if a value cannot be derived from these nodes."""
    by_name = {node.name: node for node in nodes}
    for name in derivation.fields:
        if name not in by_name:
            raise FormulaError(f"`{name}` is not derived before it")
        reason = _reason_against(by_name[name])
        if reason:
            raise FormulaError(f"`{name}` {reason}")
    for step in derivation.steps:
        if step.operator == "^" and step.right < len(derivation.fields):
            name = derivation.fields[step.right]
            scalar = scalar_of(by_name[name])
            if scalar is None or scalar.type == "float" or scalar.has_formula or scalar.bits > EXPONENT_BITS:
                what = f"only a `uint` or `int` of up to {EXPONENT_BITS} bits without a formula does"
                raise FormulaError(f"`{name}` stands behind `^`, and {what}")


def _reason_against(node: LayoutNode) -> str:
    """Return why no value can be derived from a node, as the end of a sentence; empty if one can."""
    if node.present_if:
        return "is optional"
    scalar = scalar_of(node)
    if scalar is None:
        return "is a struct"
    if isinstance(node, Array):
        return "is an array"
    return "" if scalar.type in ("uint", "int", "float") else f"is `{scalar.type}`, and no number"

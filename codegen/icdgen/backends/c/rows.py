"""Rows of a message's struct and of its checks."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c import about, encoding
from icdgen.backends.c.plan import EMPTY, Member, Plan
from icdgen.backends.c.statement import STEP, head, parameters
from icdgen.backends.c.text import comment, literal


class Declaration(NamedTuple):
    """A member of a struct."""

    comment: str
    text: str


class Misfit(NamedTuple):
    """A field that can hold raw values which do not fit."""

    test: str
    name: str


def declarations(plan: Plan) -> list[Declaration]:
    """The members of the message's struct."""
    rows = [_declaration(member) for member in plan.members]
    return rows or [Declaration(comment(["There are no fields; C has no empty structs."], STEP), f"uint8_t {EMPTY};")]


def _declaration(member: Member) -> Declaration:
    field, name, storage = member
    if field.type == "bytes":
        return Declaration(comment(about.field(field, False), STEP), f"uint8_t {name}[{field.bits // 8}];")
    narrow = field.type in ("int", "uint") and field.bits != storage.bits
    return Declaration(comment(about.field(field, narrow), STEP), f"{storage.type} {name};")


def misfits(plan: Plan) -> list[Misfit]:
    """The tests that encode makes, one a field whose C type holds more than the field."""
    return [Misfit(test, literal(name)) for name, test in encoding.excess(plan)]


def excess_type(plan: Plan) -> str:
    """The type that holds what does not fit of any field."""
    wide = any(m.storage.bits == 64 and m.field.bits < 64 for m in plan.members)
    return "uint64_t" if wide else "uint32_t"


def heads(plan: Plan) -> dict[str, str]:
    """The first lines of a message's functions, or their parameters."""
    return {
        "init_head": head("void ", f"{plan.stem}_init", f"{plan.type} *message"),
        "misfit_head": head("const char *", f"{plan.stem}_misfit", f"const {plan.type} *message"),
        "decode_parameters": parameters(
            f"{plan.type} *ICDGEN_RESTRICT message", "const uint8_t *ICDGEN_RESTRICT buffer", "size_t length"
        ),
        "encode_parameters": parameters(
            f"const {plan.type} *ICDGEN_RESTRICT message", "uint8_t *ICDGEN_RESTRICT buffer", "size_t capacity"
        ),
    }

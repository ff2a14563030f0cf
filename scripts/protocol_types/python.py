"""Protocol facts as members of the named tuples of the Python runtime.

`written` takes the text of ``link.py`` or ``packet_formats.py`` in the runtime and
returns it with the members of all facts in `icdgen.protocol.sections`. Their types and
docstrings are written again. Members that are no facts, and methods, are preserved; a
section without a class in this text is skipped. `scripts.protocol_facts` calls it.
"""

from __future__ import annotations

import ast
import textwrap

from icdgen.link_calls import type_name
from icdgen.protocol.declared import FactKind, ProtocolFact, facts_of
from icdgen.protocol.sections import SECTIONS, Settings

_TYPES = {
    FactKind.FLAG: "bool", FactKind.BUSES: "tuple[str, ...]", FactKind.SPAN: "tuple[int, int]",
}  # fmt: skip


def written(text: str) -> str:
    """Return the module with the members of all facts. Other members follow them."""
    for part in SECTIONS:
        text = _with_facts(text, part)
    return text


def _with_facts(text: str, part: type) -> str:
    name, facts = type_name(part), facts_of(part)
    class_node = next(
        (
            node
            for node in ast.parse(text).body
            if isinstance(node, ast.ClassDef) and node.name == name
        ),
        None,
    )
    if class_node is None:
        return text
    lines, names = text.splitlines(), {fact.name for fact in facts}
    members, begin, end = (
        {},
        class_node.body[0].end_lineno or 0,
        class_node.body[0].end_lineno or 0,
    )
    for statement, after in zip(
        class_node.body[1:], [*class_node.body[2:], None], strict=True
    ):
        if isinstance(statement, ast.FunctionDef):
            break
        end = statement.end_lineno or end
        if isinstance(statement, ast.AnnAssign) and isinstance(
            statement.target, ast.Name
        ):
            has_docstring = isinstance(after, ast.Expr)
            own = lines[
                statement.lineno - 1 : (
                    after.end_lineno
                    if has_docstring and after
                    else statement.end_lineno
                )
            ]
            members[statement.target.id] = own, statement.value is not None
    other_members = [own for key, own in members.items() if key not in names]
    fact_members = [
        ([_member(fact, part), *_about(fact)], fact.default in (None, ()))
        for fact in facts
    ]
    ordered = sorted([*fact_members, *other_members], key=lambda member: member[1])
    member_lines = [line for own, _ in ordered for line in own]
    return "\n".join([*lines[:begin], "", *member_lines, *lines[end:]]) + "\n"


def _member(fact: ProtocolFact, part: type) -> str:
    kind = _TYPES.get(fact.kind, "int")
    if part is Settings and fact.kind is FactKind.TIME:
        kind = "Number"  # users can set it, also to fractions
    if part is Settings:
        return f"    {fact.name}: {kind} = {fact.default}"
    if fact.is_optional:
        return f"    {fact.name}: Optional[{kind}] = None"
    return f"    {fact.name}: {kind}" + (" = ()" if fact.default == () else "")


def _about(fact: ProtocolFact) -> list[str]:
    """Return the docstring of a member."""
    meaning = fact.meaning[0].upper() + fact.meaning[1:]
    first, *following = textwrap.wrap(f'"""{meaning}."""', 84)
    return [f"    {line}" for line in (first, *following)]

"""The statements of a message's decode function."""

from __future__ import annotations

from icdgen.backends.c import bits
from icdgen.backends.c.plan import EMPTY, Member, Plan
from icdgen.backends.c.runs import Flags, Row, row_macro
from icdgen.backends.c.statement import STEP, call
from icdgen.backends.c.text import WIDTH
from icdgen.icd.model import Field


def statements(plan: Plan) -> list[str]:
    """One statement a field or a run, in the order of the struct."""
    if not plan.members:
        return ["(void)buffer;", f"message->{EMPTY} = 0u;"]
    found = []
    index = 0
    while index < len(plan.members):
        run = plan.runs.get(index)
        found.append(_run(run, plan) if run else _one(plan.members[index], plan))
        index += run.count if run else 1
    return found


def _run(run: Flags | Row, plan: Plan) -> str:
    if isinstance(run, Flags):
        value = f"buffer[{run.byte}]" + (f" >> {run.shift}" if run.shift else "")
        return call(f"ICDGEN_READ_{run.macro}", (plan.type, "message", value, *run.arguments(plan.names)))
    ends = plan.names[run.first], plan.names[run.first + run.count - 1]
    value = f"&buffer[{run.byte}]"
    return call(f"ICDGEN_READ_{row_macro(plan.node)}", (plan.type, "message", value, f"{run.count}u", *ends))


def _one(member: Member, plan: Plan) -> str:
    field, name, storage = member
    if field.type == "bytes":
        return f"memcpy(message->{name}, &buffer[{field.at // 8}], {field.bits // 8}u);"
    read = bits.read(field, plan.node, storage)
    line = _assigned(field, name, read.whole)
    if len(STEP) + len(line) <= WIDTH or len(read.terms) == 1:
        return line
    local = f"bits_{field.at}"
    first, *others = read.terms
    joined = [f"uint{read.bits}_t {local} = {first};", *(f"{local} |= {term};" for term in others)]
    return f"\n{STEP}".join([*joined, _assigned(field, name, read.value.format(bits=local))])


def _assigned(field: Field, name: str, value: str) -> str:
    if field.type == "float":
        return call(f"icdgen_set_f{field.bits}", (f"&message->{name}", value))
    return f"message->{name} = {value};"

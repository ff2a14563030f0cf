"""Plan -> the finished values that the templates print."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from icdgen import naming
from icdgen.backends.c import about, encoding, physical
from icdgen.backends.c.names import accessor_unit
from icdgen.backends.c.plan import EMPTY, Member, Plan
from icdgen.backends.c.prefixes import part_of_unit
from icdgen.backends.c.statement import STEP, call
from icdgen.backends.c.storage import mask
from icdgen.backends.c.text import WIDTH, comment, literal, plain
from icdgen.icd.model import Field


class Constant(NamedTuple):
    """A macro."""

    comment: str
    name: str
    value: str


class Declaration(NamedTuple):
    """A member of a struct."""

    comment: str
    text: str


class Misfit(NamedTuple):
    """A field that can hold raw values which do not fit."""

    test: str
    name: str


class Accessor(NamedTuple):
    """A getter and a setter of a physical value; ``test`` holds for values that the setter refuses by itself."""

    get: str
    get_comment: str
    get_lead: str
    set: str
    set_comment: str
    set_lead: str
    type: str
    expression: str
    assignment: str
    test: str = ""


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


def ids(plan: Plan) -> list[Constant]:
    """The id, or the set id and the get id."""
    message, stem = plan.message, plan.stem.upper()
    if message.id is not None:
        return [Constant(f"/** Id of the {message.kind}. */", f"{stem}_ID", f"{message.id}u")]
    return [
        Constant("/** Id of the telecommand that sets it. */", f"{stem}_SET_ID", f"{message.set_id}u"),
        Constant("/** Id of the telemetry that gets it. */", f"{stem}_GET_ID", f"{message.get_id}u"),
    ]


def constants(plan: Plan) -> list[Constant]:
    """The only valid raw values, raw values with a meaning of their own, and limits."""
    rows = []
    for field, name, storage in plan.members:
        what = plain(field.name)
        for end, value, meaning in specials(field, plan.node.vocabulary):
            literal_value = str(value) if storage.signed else mask(value, storage.bits)
            rows.append(Constant(comment([f"{what}: {meaning}"]), constant_name(plan, name, end), literal_value))
        for end, value in limits(field):
            unit = f" in {plain(field.unit.symbol)}" if field.unit else ""
            text = f"({about.number(value)})" if value < 0 else about.number(value)
            rows.append(Constant(comment([f"{what}: {_LIMITS[end]}{unit}."]), constant_name(plan, name, end), text))
    return rows


_LIMITS = {"min": "least value", "max": "largest value", "above": "must be above this", "below": "must be below this"}


def specials(field: Field, vocabulary: tuple[str, ...]) -> Iterator[tuple[str, int, str]]:
    """(end of the name, raw value, meaning) of raw values with a name of their own."""
    if field.const is not None:
        yield "const", field.const, "the only valid raw value."
    for special in field.special:
        words = naming.words(special.meaning, vocabulary)
        end = naming.snake(words) if 0 < len(words) <= 4 else f"special_{special.value}".replace("-", "minus_")
        yield end, special.value, about.sentence(special.meaning)


def limits(field: Field) -> Iterator[tuple[str, Fraction]]:
    """(end of the name, value) of the limits that there are."""
    if field.limits is not None:
        for end in _LIMITS:
            value = getattr(field.limits, end)
            if value is not None:
                yield end, value


def constant_name(plan: Plan, name: str, end: str) -> str:
    """``CUBEACP_RESET_MAGIC_NUMBER_CONST``"""
    return f"{plan.stem}_{name}_{end}".upper()


def initial(plan: Plan) -> list[str]:
    """Statements that give fields with only one valid value that value."""
    return [
        f"message->{name} = {constant_name(plan, name, 'const')};"
        for field, name, _ in plan.members
        if field.const is not None
    ]  # fmt: skip


def misfits(plan: Plan) -> list[Misfit]:
    """The tests that encode makes, one a field whose C type holds more than the field."""
    return [Misfit(test, literal(name)) for name, test in encoding.excess(plan)]


def excess_type(plan: Plan) -> str:
    """The type that holds what does not fit of any field."""
    wide = any(m.storage.bits == 64 and m.field.bits < 64 for m in plan.members)
    return "uint64_t" if wide else "uint32_t"


def lead(head: str, parameters: str) -> str:
    """What stands before the parameters of a function: a new line if all does not fit on one."""
    return "" if len(head) + len(parameters) + 2 <= WIDTH else f"\n{STEP}"


def leads(plan: Plan) -> dict[str, str]:
    """How the parameters of a message's functions are laid out."""
    encoding_parameters = (
        f"{STEP}const {plan.type} *ICDGEN_RESTRICT message, uint8_t *ICDGEN_RESTRICT buffer, size_t capacity)"
    )
    return {
        "init_lead": lead(f"static inline void {plan.stem}_init", f"{plan.type} *message"),
        "misfit_lead": lead(f"static inline const char *{plan.stem}_misfit", f"const {plan.type} *message"),
        "apart": " " if len(encoding_parameters) <= WIDTH else f"\n{STEP}",
    }


def accessors(plan: Plan) -> list[Accessor]:
    """In double precision."""
    return [_double(plan, member) for member in plan.members if member.field.scale is not None]


def _double(plan: Plan, member: Member) -> Accessor:
    field, name, storage = member
    scaled = physical.scaled(field, storage)
    unit = accessor_unit(field)
    what = plain(field.name) + (f" in {plain(field.unit.symbol)}" if field.unit else "")
    function, *arguments = scaled.setter
    return _accessor(
        plan,
        (f"{name}_{unit}", "double"),
        (f"{what}: {about.formula(field)}, {about.physical_range(field)}.", what),
        scaled.getter.format(raw=f"message->{name}"),
        call(f"return {function}", (f"&message->{name}", *arguments)),
    )


def whole_accessors(plan: Plan) -> list[Accessor]:
    """In whole thousandths or millionths of the unit."""
    scaled = (m for m in plan.members if m.field.scale is not None)
    wholes = ((m, physical.scaled(m.field, m.storage).whole) for m in scaled)
    return [_whole(plan, member, whole) for member, whole in wholes if whole is not None]


def _whole(plan: Plan, member: Member, whole: physical.Whole) -> Accessor:
    field, name, _ = member
    suffix, words = part_of_unit(field, whole.prefix)
    what = f"{plain(field.name)} in {plain(words)}"
    tests = [f"value < {whole.least}"] if whole.least is not None else []
    tests += [f"value > {whole.most}"] if whole.most is not None else []
    return _accessor(
        plan,
        (f"{name}_{suffix}", whole.type),
        (f"{what}, exact: {whole.low} to {whole.high}.", what),
        whole.getter.format(raw=f"message->{name}"),
        f"message->{name} = {whole.setter};",
        " || ".join(tests),
    )


def _accessor(
    plan: Plan, ends: tuple[str, str], texts: tuple[str, str], expression: str, assignment: str, test: str = ""
) -> Accessor:
    (end, type_name), (get_text, what) = ends, texts
    getter, setter = f"{plan.stem}_{end}", f"{plan.stem}_set_{end}"
    return Accessor(
        get=getter,
        get_comment=comment([get_text]),
        get_lead=lead(f"static inline {type_name} {getter}", f"const {plan.type} *message"),
        set=setter,
        set_comment=comment([f"Sets {what} to the nearest raw value; ICD_ERROR_RANGE if there is none."]),
        set_lead=lead(f"static inline icd_status_t {setter}", f"{plan.type} *message, {type_name} value"),
        type=type_name,
        expression=expression,
        assignment=assignment,
        test=test,
    )

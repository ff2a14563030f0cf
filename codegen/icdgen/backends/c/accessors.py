"""Accessors of physical values."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.c import physical
from icdgen.backends.c.names import stem
from icdgen.backends.c.prefixes import part_of_unit
from icdgen.backends.c.statement import call, head
from icdgen.backends.c.text import comment
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.comments import physical_comment, physical_name, words


class Accessor(NamedTuple):
    """A getter and a setter of a physical value; ``test`` holds for values that the setter refuses by itself."""

    get_comment: str
    get_head: str
    set_comment: str
    set_head: str
    expression: str
    assignment: str
    test: str = ""


def accessors(message: MessageDescription) -> list[Accessor]:
    """In double precision."""
    return [_double(field) for field in message.fields if field.steps is not None]


def _double(field: FieldDescription) -> Accessor:
    assert field.steps is not None
    scaled = physical.scaled(field)
    what = physical_name(field.model)
    function, *arguments = scaled.setter
    return _accessor(
        field,
        (field.physical_name, "double"),
        (physical_comment(field.model, field.steps), what),
        scaled.getter,
        call(f"return {function}", (f"&message->{field.name}", *arguments)),
    )


def whole_accessors(message: MessageDescription) -> list[Accessor]:
    """In whole thousandths or millionths of the unit."""
    wholes = ((field, physical.scaled(field).whole) for field in message.fields if field.steps is not None)
    return [_whole(field, whole) for field, whole in wholes if whole is not None]


def whole_name(field: FieldDescription, whole: physical.Whole) -> str:
    """``estimated_roll_angle_mdeg``"""
    return f"{field.name}_{part_of_unit(field.model, whole.prefix)[0]}"


def _whole(field: FieldDescription, whole: physical.Whole) -> Accessor:
    what = f"{words(field.model.name)} in {words(part_of_unit(field.model, whole.prefix)[1])}"
    tests = [f"value < {whole.least}"] if whole.least is not None else []
    tests += [f"value > {whole.most}"] if whole.most is not None else []
    return _accessor(
        field,
        (whole_name(field, whole), whole.type),
        (f"{what}, exact: {whole.low} to {whole.high}.", what),
        whole.getter,
        f"message->{field.name} = {whole.setter};",
        " || ".join(tests),
    )


def _accessor(
    field: FieldDescription,
    ends: tuple[str, str],
    texts: tuple[str, str],
    getter: str,
    assignment: str,
    test: str = "",
) -> Accessor:
    (end, type_name), (get_text, what), name = ends, texts, stem(field.message)
    return Accessor(
        get_comment=comment([get_text]),
        get_head=head(f"{type_name} ", f"{name}_{end}", f"const {name}_t *message"),
        set_comment=comment([f"Sets {what} to the nearest raw value; ICD_ERROR_RANGE if there is none."]),
        set_head=head("icd_status_t ", f"{name}_set_{end}", f"{name}_t *message", f"{type_name} value"),
        expression=getter.format(raw=f"message->{field.name}"),
        assignment=assignment,
        test=test,
    )

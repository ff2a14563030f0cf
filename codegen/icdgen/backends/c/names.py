"""The C names of messages and enumerations. All names at file scope begin with the name of the declaring node, once."""

from __future__ import annotations

from typing import Any

from icdgen.describe import EnumDescription, FieldDescription, MessageDescription
from icdgen.describe.description import Composite
from icdgen.describe.enums import MemberDescription


def stem(one: Composite[Any] | EnumDescription) -> str:
    """``demo_estimated_roll``: stem of the functions and the type; of ``DemoState`` ``demo_state``, for it has the node's name."""
    prefix = f"{one.node.name}_"
    return one.name if one.name.startswith(prefix) else prefix + one.name


def enumerator(enum: EnumDescription, member: MemberDescription) -> str:
    """``DEMO_MODE_IDLE``"""
    return f"{stem(enum)}_{member.name}".upper()


def reading(message: MessageDescription, name: str) -> str:
    """The function that reads an element of an array of structs; ``name`` is that of `icdgen.describe.repeated`."""
    return f"{stem(message)}_read_{name}"


def writing(message: MessageDescription, name: str) -> str:
    """The function that writes one."""
    return f"{stem(message)}_write_{name}"


def walking(message: MessageDescription, name: str) -> str:
    """The function that reads one of a frame that is not decoded."""
    return f"{stem(message)}_{name}_at"


def has(field: FieldDescription) -> str:
    """``demo_wheel_has_rate``: the function that tells whether a field is there."""
    return f"{stem(field.message)}_has_{field.name}"


def constant(message: Composite[Any], name: str) -> str:
    """``DEMO_RESET_MAGIC_NUMBER_CONST``; ``DEMO_RESET_ID``"""
    return f"{stem(message)}_{name}".upper()


def enumerator_of(direction: str, message: MessageDescription) -> str:
    """``DEMO_TELEMETRY_IS_STATUS``, where messages of ``demo_telemetry`` share ids."""
    return f"{direction}_is_{message.name}".upper()

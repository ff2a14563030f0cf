"""Values and statements of examples in the documentation of generated code.

`icdgen.describe.examples` chooses field and value. ``cargo test`` runs the examples, so
they must compile.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from icdgen import codec
from icdgen.backends.rust.accessors import accessors
from icdgen.backends.rust.names import ENUMS_MODULE, field_name, setter
from icdgen.backends.rust.symbols import RUST_NAMES
from icdgen.backends.rust.text import double, integer, mask
from icdgen.describe import MessageDescription, NodeDescription
from icdgen.describe.examples import ExampleValue
from icdgen.describe.links import LinkDescription

_SHORT = 8
"""Bytes of a frame up to which an example shows all; of longer frames it shows the
bytes that are not 0.
"""


def is_short(frame: Sequence[int]) -> bool:
    """Return whether an example shows all bytes of a frame."""
    return len(frame) <= _SHORT


def client_message(
    node: NodeDescription, link: LinkDescription | None
) -> MessageDescription | None:
    """Return the message that a client on a UART requests in an example: the first
    short one with a scale, else the first short one.

    None without a UART or short messages.
    """
    if link is None or link.facts.framing is None:
        return None
    short = [
        message
        for message in node.telemetry
        if message.model.telemetry_id in link.facts.telemetry
        and message.model.length <= _SHORT
    ]
    scaled = (
        message
        for message in short
        if any(field.is_scaled for field in message.members)
    )
    return next(scaled, short[0] if short else None)


def read_example(shown: ExampleValue) -> str:
    """Return the assertion that ``message`` has the value."""
    field = shown.field
    if shown.physical is not None:
        return f"assert_eq!(message.{field.physical_name}(), {double(shown.physical)});"
    value = f"message.{field_name(field)}"
    return (
        f"assert!({value});"
        if field.model.type == "bool"
        else f"assert_eq!({value}, {_value_literal(shown)});"
    )


def write_example(shown: ExampleValue) -> str:
    """Return the statement that sets the value in ``command``."""
    field = shown.field
    # The first accessor is that of the double. Without a setter, the raw value is set.
    if shown.physical is not None and accessors(field)[0].raw:
        return f"command.{setter(field.physical_name)}({double(shown.physical)})?;"
    # The member has the type `Coded`, which also stores numbers without a name.
    into = ".into()" if field.enum else ""
    return f"command.{field_name(field)} = {_value_literal(shown)}{into};"


def _value_literal(shown: ExampleValue) -> str:
    """Return the literal of the raw value."""
    field, raw = shown.field, shown.raw
    if field.enum is not None:
        member = field.enum.member(raw)
        assert member is not None, "an example of an enumeration is a member of it"
        return f"{ENUMS_MODULE}::{RUST_NAMES.symbol(field.enum, 'type')}::{RUST_NAMES.symbol(member, 'variant')}"
    if field.model.type == "bool":
        return "true" if raw else "false"
    return (
        double(codec.float_value(field.model, raw))
        if field.model.type == "float"
        else integer(raw)
    )


def byte_array(data: Iterable[int]) -> str:
    """Return the literal of an array of bytes."""
    return f"[{', '.join(map(mask, data))}]"

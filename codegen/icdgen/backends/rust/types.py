"""Types of raw values in Rust, and paths of the types of messages, structs and
enumerations.

A path depends on the module in which it stands, so each function gets the node of that
module.
"""

from __future__ import annotations

from typing import Any

from icdgen.backends.rust.names import ENUMS_MODULE
from icdgen.backends.rust.symbols import RUST_NAMES
from icdgen.describe import EnumDescription, FieldDescription, MessageDescription
from icdgen.describe.description import Composite
from icdgen.icd.model import Node


def enum_path(enum: EnumDescription, node: Node) -> str:
    """Return the path of an enumeration in the modules of the messages of ``node``."""
    name = f"{ENUMS_MODULE}::{RUST_NAMES.symbol(enum, 'type')}"
    return name if enum.node.name == node.name else f"crate::{enum.node.name}::{name}"


def reason_number(enum: EnumDescription) -> str:
    """Return the expression that converts `code`, the number of a reason in 32 bits, to
    the storage of its enumeration. A number that does not fit is its largest value.
    """
    bits = enum.storage.bits
    if bits == 32:
        return "code"
    if bits == 64:
        return "u64::from(code)"
    return f"u{bits}::try_from(code).unwrap_or(u{bits}::MAX)"


def message_path(message: MessageDescription, node: Node) -> str:
    """Return the path of the type of a message in the module of ``node``."""
    name = RUST_NAMES.symbol(message, "type")
    return (
        name
        if message.node.name == node.name
        else f"crate::{message.node.name}::{name}"
    )


def struct_path(struct: Composite[Any], node: Node) -> str:
    """Return the path of the type of a struct or message in the modules of the messages
    of ``node``.
    """
    # The module of a message is private to the module of its node, which exports the
    # types of all its messages and structs.
    module = "super" if struct.node.name == node.name else f"crate::{struct.node.name}"
    return f"{module}::{RUST_NAMES.symbol(struct, 'type')}"


def integer_type(field: FieldDescription) -> str:
    """Return the integer type that stores the raw value."""
    return f"{'i' if field.storage.signed else 'u'}{field.storage.bits}"


def raw_type(field: FieldDescription) -> str:
    """Return the type of the raw value in the struct of the message."""
    if field.model.conditions:
        return f"Option<{one_type(field)}>"
    return f"[{one_type(field)}; {field.count}]" if field.count else one_type(field)


def open_type(field: FieldDescription) -> str:
    """Return the type of a slice of the elements that are in a frame."""
    return f"[{one_type(field)}]" if field.count else "[u8]"


def one_type(field: FieldDescription) -> str:
    """Return the type of the raw value; for an array that of an element."""
    place = field.model
    if field.struct is not None:
        return struct_path(field.struct, field.message.node)
    if field.enum is not None:
        return f"Coded<{enum_path(field.enum, field.message.node)}>"
    if place.is_bytes:
        return f"[u8; {place.bits // 8}]"
    if place.type == "float":
        return f"f{place.bits}"
    return "bool" if place.type == "bool" else integer_type(field)

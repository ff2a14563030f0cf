"""Names in Rust: of types, variants and modules, and the words that cannot be names."""

from __future__ import annotations

from typing import Any

from icdgen.describe import EnumDescription, FieldDescription, MessageDescription
from icdgen.describe.description import Composite
from icdgen.describe.enums import MemberDescription
from icdgen.icd.model import Node
from icdgen.naming import camel

# Strict, reserved and weak keywords of the editions 2015 to 2024 that no item, field or variant may be called without `r#`.
RESERVED = frozenset("""
    as async await break const continue crate dyn else enum extern false fn for gen if impl in let loop match mod move
    mut pub ref return self Self static struct super trait true try type unsafe use where while
    abstract become box do final macro override priv typeof unsized virtual yield _
    """.split())

# Those of them that cannot be written with `r#` either.
NEVER = frozenset(("self", "Self", "super", "crate", "_"))
_RAW = RESERVED - NEVER

# Types and traits that the generated modules call by their bare name, in the scope where a message's type stands.
USED_TYPES = ("Result", "Error", "Default", "Coded", "Scale", "Telemetry", "Telecommand", "Node")
# What stands beside the modules of the nodes.
USED_MODULES = ("support", "std", "wire")
# What a folder of that name in `src` means to Cargo and rustc.
ROOTS = {"lib": "the root of the crate", "main": "the root of a program", "bin": "the folder of programs"}
ENUMS_MODULE = "enums"
# What stands beside the modules of a node's messages, and what their parent calls by its bare name.
USED_IN_NODES = (ENUMS_MODULE, "u8", "u16", "u32", "u64", "usize", "str", "serde", "defmt")
# The variant of an enumeration that keeps values without a name; the first that no member is called.
CATCH_ALL = ("Unknown", "Unlisted", "Unnamed", "AnyOther")


def type_name(one: Composite[Any] | EnumDescription | MemberDescription) -> str:
    """``EstimatedAttitudeAngles``; of a member, the name of its variant: ``NoControl``."""
    return one.camel_name


def field_name(field: FieldDescription) -> str:
    """``estimated_roll_angle``; ``r#type`` where the name is a keyword; ``temperatures[3]``; ``satellites[2].gnss``."""
    return raw_words(field.member)


def raw_words(expression: str) -> str:
    """An expression of members, keywords among them as names."""
    return ".".join(f"r#{part}" if part.partition("[")[0] in _RAW else part for part in expression.split("."))


def own_name(field: FieldDescription) -> str:
    """What it is called in the message, or in the struct, that declares it."""
    return f"r#{field.declared_name}" if field.declared_name in _RAW else field.declared_name


def variant(word: str) -> str:
    """``UnknownId`` of ``unknown_id``: a word of the protocol as a variant of its enumeration."""
    return camel(tuple(word.split("_")))


def catch_all(enum: EnumDescription) -> str:
    """The variant for values without a name."""
    taken = {type_name(member) for member in enum.members}
    return next((name for name in CATCH_ALL if name not in taken), CATCH_ALL[0])


def enum_path(enum: EnumDescription, node: Node) -> str:
    """The type as the messages of ``node`` write it."""
    name = f"{ENUMS_MODULE}::{type_name(enum)}"
    return name if enum.node.name == node.name else f"crate::{enum.node.name}::{name}"


def message_path(message: MessageDescription, node: Node) -> str:
    """The type of a message as the module of ``node`` writes it."""
    return type_name(message) if message.node.name == node.name else f"crate::{message.node.name}::{type_name(message)}"


def struct_path(struct: Composite[Any], node: Node) -> str:
    """The type of a struct, or of a message, as the messages of ``node`` write it."""
    return f"{'super' if struct.node.name == node.name else f'crate::{struct.node.name}'}::{type_name(struct)}"


def integer_type(field: FieldDescription) -> str:
    """The integer that holds the raw value."""
    return f"{'i' if field.storage.signed else 'u'}{field.storage.bits}"


def raw_type(field: FieldDescription) -> str:
    """Type of the raw value in the message's struct."""
    if field.model.conditions:
        return f"Option<{one_type(field)}>"
    return f"[{one_type(field)}; {field.count}]" if field.count else one_type(field)


def has(field: FieldDescription) -> str:
    """``has_rate``: the method that tells whether a field is there."""
    return f"has_{field.name}"


def constant_name(name: str) -> str:
    """``TIMEOUT_NO_TIMEOUT``: constant of a message with this name in snake case."""
    return name.upper()


def setter(name: str) -> str:
    """``set_rate_deg_per_s``: the method that sets a physical value by its name in snake case."""
    return f"set_{name}"


def open_type(field: FieldDescription) -> str:
    """Type of the elements that are in a frame."""
    return f"[{one_type(field)}]" if field.count else "[u8]"


def one_type(field: FieldDescription) -> str:
    """Type of the raw value, or of an element."""
    one = field.model
    if field.struct is not None:
        return struct_path(field.struct, field.message.node)
    if field.enum is not None:
        return f"Coded<{enum_path(field.enum, field.message.node)}>"
    if one.is_bytes:
        return f"[u8; {one.bits // 8}]"
    if one.type == "float":
        return f"f{one.bits}"
    return "bool" if one.type == "bool" else integer_type(field)

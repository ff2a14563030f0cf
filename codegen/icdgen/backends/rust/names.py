"""Names in Rust: identifiers of everything that the generated crate declares, and the words that cannot be."""

from __future__ import annotations

from icdgen.icd.model import Enum, Field, Icd, Member, Message, Node
from icdgen.naming import camel, snake, upper, words

# Strict, reserved and weak keywords of the editions 2015 to 2024 that no item, field or variant may be called without `r#`.
RESERVED = frozenset("""
    as async await break const continue crate dyn else enum extern false fn for gen if impl in let loop match mod move
    mut pub ref return self Self static struct super trait true try type unsafe use where while
    abstract become box do final macro override priv typeof unsized virtual yield _
    """.split())

# Types and traits that the generated modules call by their bare name, in the scope where a message's type stands.
USED_TYPES = ("Result", "Error", "Default", "Coded", "Scale", "Telemetry", "Telecommand")
# What stands beside the modules of the nodes.
USED_MODULES = ("support", "std", "wire")
# What a folder of that name in `src` means to Cargo and rustc.
ROOTS = {"lib": "the root of the crate", "main": "the root of a program", "bin": "the folder of programs"}
ENUMS_MODULE = "enums"
# What stands beside the modules of a node's messages, and what their parent calls by its bare name.
USED_IN_NODES = (ENUMS_MODULE, "u8", "u16", "u32", "u64", "usize", "str", "serde", "defmt")
# The variant of an enumeration that keeps values without a name; the first that no member is called.
CATCH_ALL = ("Unknown", "Unlisted", "Unnamed", "AnyOther")


def parts(thing: Message | Field | Enum | Member, node: Node) -> tuple[str, ...]:
    """Words of the thing's name."""
    return words(thing.identifier or thing.name, node.vocabulary)


def type_name(thing: Message | Enum, node: Node) -> str:
    """``EstimatedAttitudeAngles``"""
    return camel(parts(thing, node))


def file_name(message: Message, node: Node) -> str:
    """Module of a message."""
    return snake(parts(message, node))


def field_name(field: Field, node: Node) -> str:
    """``estimated_roll_angle``"""
    return snake(parts(field, node))


def constant_name(field: Field, node: Node) -> str:
    """``ESTIMATED_ROLL_ANGLE``"""
    return upper(parts(field, node))


def physical_name(field: Field, name: str) -> str:
    """Name of the physical getter of the field that is called ``name``: ``estimated_roll_angle_deg``."""
    return f"{name}_{field.unit.identifier if field.unit else 'physical'}"


def variant_name(member: Member, node: Node) -> str:
    """``NoControl``"""
    return camel(parts(member, node))


def catch_all(enum: Enum, node: Node) -> str:
    """The variant for values without a name."""
    taken = {variant_name(member, node) for member in enum.members}
    return next((name for name in CATCH_ALL if name not in taken), CATCH_ALL[0])


class Enums:
    """Where each enumeration's type stands, and the integer that holds its values."""

    def __init__(self, icd: Icd) -> None:
        self._nodes = {node.name: node for node in icd.nodes}
        self._bits: dict[tuple[str, str], int] = {}
        self._paths: dict[tuple[str, str, str], str] = {}
        for node in icd.nodes:
            for enum in node.enums:
                self._widen(enum, max((member.value.bit_length() for member in enum.members), default=1))
            for message in node.messages:
                for field in message.fields:
                    if field.enum is not None:
                        self._widen(field.enum, field.bits)

    def _widen(self, enum: Enum, bits: int) -> None:
        key = (enum.node, enum.name)
        self._bits[key] = max(self._bits.get(key, 1), bits)

    def storage(self, enum: Enum) -> int:
        """8, 16, 32 or 64: bits of the integer that holds every value of the enumeration."""
        return storage(self._bits[enum.node, enum.name])

    def path(self, enum: Enum, node: Node) -> str:
        """The type as the messages of ``node`` write it."""
        key = (enum.node, enum.name, node.name)
        if key not in self._paths:
            name = f"{ENUMS_MODULE}::{type_name(enum, self._nodes[enum.node])}"
            self._paths[key] = name if enum.node == node.name else f"crate::{enum.node}::{name}"
        return self._paths[key]


def storage(bits: int) -> int:
    """The smallest of 8, 16, 32 and 64 that ``bits`` fit in."""
    return 8 if bits <= 8 else 16 if bits <= 16 else 32 if bits <= 32 else 64


def integer_type(field: Field) -> str:
    """The integer that holds the raw value."""
    return f"{'i' if field.type == 'int' else 'u'}{storage(field.bits)}"

"""Names in Rust of fields, methods and constants, and the words that cannot be names.

A keyword such as ``type`` becomes a raw identifier, ``r#type``. The symbol table
(`symbols`) uses the same functions.
"""

from __future__ import annotations

from icdgen.describe import FieldDescription
from icdgen.naming import camel

# Strict, reserved and weak keywords of the editions 2015 to 2024 that no item, field or
# variant may be called without `r#`.
RESERVED = frozenset(
    """
    as async await break const continue crate dyn else enum extern false fn for gen if impl in let loop match mod move
    mut pub ref return self Self static struct super trait true try type unsafe use where while
    abstract become box do final macro override priv typeof unsized virtual yield _
    """.split()
)

# Keywords that cannot be raw identifiers (Rust reference, "Identifiers").
NEVER = frozenset(("self", "Self", "super", "crate", "_"))
_RAW = RESERVED - NEVER

# Types and traits that generated modules use by their bare names. A type of a message
# with such a name would hide them.
USED_TYPES = (
    "Result",
    "Error",
    "Default",
    "Coded",
    "Scale",
    "Telemetry",
    "Telecommand",
    "Node",
)
# Modules of the crate, next to those of the nodes.
USED_MODULES = ("support", "std", "wire")
# Names in `src` that have a meaning for Cargo, which finds targets by them.
ROOTS = {
    "lib": "the root of the crate",
    "main": "the root of a program",
    "bin": "the folder of programs",
}
ENUMS_MODULE = "enums"
PROCEDURES_MODULE = "procedures"
# Modules next to those of the messages of a node, and types and crates that the module
# of the node uses by their bare names.
USED_IN_NODES = (
    ENUMS_MODULE,
    PROCEDURES_MODULE,
    "u8",
    "u16",
    "u32",
    "u64",
    "usize",
    "str",
    "serde",
    "defmt",
)


def field_name(field: FieldDescription) -> str:
    """Return the expression of a field in its message: ``estimated_roll_angle``,
    ``temperatures[3]``, ``satellites[2].gnss``; ``r#type`` if the name is a keyword.
    """
    return raw_words(field.member)


def raw_words(expression: str) -> str:
    """Return an expression of members with keywords as raw identifiers."""
    # Only the name in front of an index can be a keyword: `type[3]` becomes
    # `r#type[3]`.
    return ".".join(
        f"r#{part}" if part.partition("[")[0] in _RAW else part
        for part in expression.split(".")
    )


def own_name(field: FieldDescription) -> str:
    """Return the name of a field in the message or struct that declares it."""
    return (
        f"r#{field.declared_name}"
        if field.declared_name in _RAW
        else field.declared_name
    )


def variant(word: str) -> str:
    """Return the variant of an enumeration for a word of the protocol: ``UnknownId``
    for ``unknown_id``.
    """
    return camel(tuple(word.split("_")))


def has(field: FieldDescription) -> str:
    """Return the name of the method that returns whether a field is present:
    ``has_rate``.
    """
    return f"has_{field.name}"


def scale_name(field: FieldDescription) -> str:
    """Return the name of the constant with the scale of a field, in the module of its
    message: ``RATE``.
    """
    return field.declared_name.upper()


def constant_name(name: str) -> str:
    """Return the name of a constant of a message by its name in snake case:
    ``TIMEOUT_NO_TIMEOUT``.
    """
    return name.upper()


def memory_constant(procedure: str) -> str:
    """Return the name of the constant with the memory in bytes that a procedure needs:
    ``DOWNLOAD_MEMORY``.
    """
    return f"{constant_name(procedure)}_MEMORY"


def setter(name: str) -> str:
    """Return the name of the method that sets a physical value, by the name of the
    value in snake case: ``set_rate_deg_per_s``.
    """
    return f"set_{name}"


def reader(name: str) -> str:
    """Return the name of the function that reads an element or an iteration of an
    array.
    """
    return f"read_{name}"


def writer(name: str) -> str:
    """Return the name of the function that writes an element or an iteration of an
    array.
    """
    return f"write_{name}"

"""Names in Rust of fields, methods and constants, and the words that cannot be names."""

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

# Those of them that cannot be written with `r#` either.
NEVER = frozenset(("self", "Self", "super", "crate", "_"))
_RAW = RESERVED - NEVER

# Types and traits that the generated modules call by their bare name, in the scope
# where a message's type stands.
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
# What stands beside the modules of the nodes.
USED_MODULES = ("support", "std", "wire")
# What a folder of that name in `src` means to Cargo and rustc.
ROOTS = {
    "lib": "the root of the crate",
    "main": "the root of a program",
    "bin": "the folder of programs",
}
ENUMS_MODULE = "enums"
PROCEDURES_MODULE = "procedures"
# What stands beside the modules of a node's messages, and what their parent calls by
# its bare name.
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
    """``estimated_roll_angle``; ``r#type`` where the name is a keyword;
    ``temperatures[3]``; ``satellites[2].gnss``.
    """
    return raw_words(field.member)


def raw_words(expression: str) -> str:
    """An expression of members, keywords among them as names."""
    return ".".join(
        f"r#{part}" if part.partition("[")[0] in _RAW else part
        for part in expression.split(".")
    )


def own_name(field: FieldDescription) -> str:
    """What it is called in the message, or in the struct, that declares it."""
    return (
        f"r#{field.declared_name}"
        if field.declared_name in _RAW
        else field.declared_name
    )


def variant(word: str) -> str:
    """``UnknownId`` of ``unknown_id``: a word of the protocol as a variant of its
    enumeration.
    """
    return camel(tuple(word.split("_")))


def has(field: FieldDescription) -> str:
    """``has_rate``: the method that tells whether a field is there."""
    return f"has_{field.name}"


def scale_name(field: FieldDescription) -> str:
    """``RATE``: constant of the module of a message with the scale of a field."""
    return field.declared_name.upper()


def constant_name(name: str) -> str:
    """``TIMEOUT_NO_TIMEOUT``: constant of a message with this name in snake case."""
    return name.upper()


def memory_constant(procedure: str) -> str:
    """``DOWNLOAD_MEMORY``: constant with the memory in bytes that a procedure needs."""
    return f"{constant_name(procedure)}_MEMORY"


def setter(name: str) -> str:
    """``set_rate_deg_per_s``: the method that sets a physical value by its name in
    snake case.
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

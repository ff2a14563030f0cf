"""Declaration of protocol facts. Each fact is declared once, as a field of a frozen
dataclass::

    reply_timeout: int = time("reply_timeout_ms", "time-out of a reply", default=1000)

This line defines the JSON Schema of the protocol section, the reader, the types in
`runtime/` and the initializers in generated links. After a change, run `python -m
scripts.protocol_facts` to write the schema and `runtime/`.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import field, fields
from enum import Enum, auto
from functools import cache
from typing import Any, Final

from icdgen.frozen import dataclass

BYTE, U16, U32 = 0xFF, 0xFFFF, 0xFFFF_FFFF
# Upper limit of a time: half of 32 bits, so that times compare across a clock overflow
MOST_MS = 0x7FFF_FFFF
# No default: without this key, the ICD does not describe the part
REQUIRED: Final = object()


class FactKind(Enum):
    """Kind of a fact. Each language has one type and one notation for each kind."""

    NUMBER = auto()
    SIZE = auto()  # number of bytes, or byte position
    TIME = auto()  # in milliseconds
    OCTET = auto()  # a byte on the wire
    CODE = auto()  # a number that is read in hexadecimal
    FLAG = auto()
    BUSES = auto()  # some of UART, I2C and CAN
    SPAN = auto()  # (byte position, number of bytes)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ProtocolFact:
    """Protocol fact.

    ``least`` and ``most`` limit the value in the ICD. ``holds`` is the largest value of
    the type in generated code.
    """

    name: str
    kind: FactKind
    key: str  # dotted key within the section of the ICD; empty: derived from other keys
    about: str  # meaning, beginning in lower case
    least: int = 0
    most: int | None = None
    holds: int = U32
    default: object = REQUIRED
    # Of a flag: values in the ICD for false and for true
    words: tuple[object, ...] = ()
    listed: str = ""  # of a flag: entry of the ICD's list that sets it
    key_about: str = ""  # meaning of the key, if it differs from `about`

    @property
    def is_optional(self) -> bool:
        """Whether the value can be unknown (None)."""
        return self.default is None

    @property
    def meaning(self) -> str:
        """Meaning with its unit."""
        return (
            f"{self.about}, in milliseconds"
            if self.kind is FactKind.TIME
            else self.about
        )

    def given(self, section: Mapping[str, Any]) -> object:
        """Return the value in the ICD; None if the key is missing."""
        value: Any = section
        for part in self.key.split("."):
            value = value.get(part) if isinstance(value, Mapping) else None
        return value

    def read_value(
        self, section: Mapping[str, Any], preceding: Mapping[str, object]
    ) -> object:
        """Return the value of the fact in a section.

        ``preceding``: values of the facts before it; a default may be computed from
        them.
        """
        value = self.given(section) if self.key else None
        if value is None:
            return self.default(preceding) if callable(self.default) else self.default
        if self.kind is FactKind.FLAG:
            # The schema allows no value but those in `words`.
            return self.listed in value if self.listed else value == self.words[1]  # type: ignore[operator]
        return value


# a value, None for an optional fact, or a function of the preceding facts
Default = object


def _declare(
    kind: FactKind, key: str, about: str, default: Default = REQUIRED, **more: Any
) -> Any:
    """Return the field of a dataclass that carries the declaration."""
    metadata = {"fact": (kind, key, about, default, more)}
    # A computed default depends on other facts, so `read_part` supplies it.
    if default is REQUIRED or callable(default):
        return field(metadata=metadata)
    return field(default=default, metadata=metadata)


def number(
    key: str,
    about: str,
    least: int = 0,
    most: int | None = None,
    default: Default = REQUIRED,
    holds: int | None = None,
) -> Any:
    """Declare a number."""
    return _declare(
        FactKind.NUMBER,
        key,
        about,
        default,
        least=least,
        most=most,
        holds=holds or most or U32,
    )


def octets(
    key: str,
    about: str,
    least: int = 1,
    most: int | None = U16,
    default: Default = REQUIRED,
    holds: int | None = None,
) -> Any:
    """Declare a number of bytes, or a byte position."""
    return _declare(
        FactKind.SIZE,
        key,
        about,
        default,
        least=least,
        most=most,
        holds=holds or most or U32,
    )


def time(key: str, about: str, default: Default = REQUIRED, least: int = 1) -> Any:
    """Declare a time in milliseconds."""
    return _declare(FactKind.TIME, key, about, default, least=least, most=MOST_MS)


def octet(key: str, about: str, default: Default = REQUIRED) -> Any:
    """Declare a byte of the transmission."""
    return _declare(FactKind.OCTET, key, about, default, most=BYTE, holds=BYTE)


def code(key: str, about: str, default: Default = REQUIRED) -> Any:
    """Declare a number of up to 32 bits that is read in hexadecimal."""
    return _declare(FactKind.CODE, key, about, default)


def flag(
    key: str,
    about: str,
    default: Default = REQUIRED,
    words: tuple[object, ...] = (False, True),
    listed: str = "",
    key_about: str = "",
) -> Any:
    """Declare a flag.

    ``words``: values in the ICD for false and for true. ``listed``: entry of a list in
    the ICD that sets the flag; then ``words`` are the entries of the list.
    """
    return _declare(
        FactKind.FLAG,
        key,
        about,
        default,
        words=words,
        listed=listed,
        key_about=key_about,
    )


def buses(about: str) -> Any:
    """Declare a set of buses out of UART, I2C and CAN, which `ProtocolReader.checksum`
    computes.
    """
    return _declare(FactKind.BUSES, "", about)


def span(about: str) -> Any:
    """Declare a byte position and a number of bytes."""
    return _declare(FactKind.SPAN, "", about)


def facts_of(part: Any) -> tuple[ProtocolFact, ...]:
    """Return the declared facts of a dataclass or of its instance, in order.

    Fields without a declaration are computed by `icdgen.protocol.reading`.
    """
    return _facts(part if isinstance(part, type) else type(part))


# Cached by class: an instance need not be hashable.
@cache
def _facts(part: Hashable) -> tuple[ProtocolFact, ...]:
    assert isinstance(part, type)
    declarations = (
        (item.name, *item.metadata["fact"])
        for item in fields(part)
        if "fact" in item.metadata
    )
    return tuple(
        ProtocolFact(name, kind, key, about, default=default, **more)
        for name, kind, key, about, default, more in declarations
    )


def read_part(
    part: type[Any],
    section: Mapping[str, Any],
    **computed: object,
) -> Any:
    """Read a part from its section; None if a key without a default is missing.

    ``computed``: values that follow from other keys.
    """
    # Facts are read in the order of declaration: defaults may use the preceding ones.
    values = dict(computed)
    for fact in facts_of(part):
        if fact.name in values:
            continue
        value = fact.read_value(section, values)
        if value is REQUIRED:
            return None
        values[fact.name] = value
    return part(**values)

"""How a fact of the protocol is declared: once, as a field of a frozen dataclass.

    reply_timeout: int = time("reply_timeout_ms", "how long a reply may take", default=1000)

The JSON Schema of the ICD's protocol section, the reader, the types in `runtime/` and the initialisers in generated links
are all made from that line. After a change, `python -m scripts.protocol_facts` writes the schema and `runtime/`.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import field, fields
from enum import Enum, auto
from functools import cache
from typing import Any, Final

from icdgen.frozen import dataclass

BYTE, U16, U32 = 0xFF, 0xFFFF, 0xFFFF_FFFF
MOST_MS = 0x7FFF_FFFF  # of a time: half of what 32 bits hold, so that times can be compared where clocks run over
REQUIRED: Final = object()  # there is no default: without the key, the ICD does not describe the part


class Kind(Enum):
    """What a fact is; each language has one type for it and one way to spell it."""

    NUMBER = auto()
    SIZE = auto()  # a number of bytes, or where something stands
    TIME = auto()  # in milliseconds
    OCTET = auto()  # a byte on the wire
    CODE = auto()  # a number that is read in hexadecimal
    FLAG = auto()
    BUSES = auto()  # some of UART, I2C and CAN
    SPAN = auto()  # (where bytes stand, how many they are)
    ALLOWED = auto()  # bytes that can be chosen; none: all
    STEP = auto()  # a message and its fields by role


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Fact:
    """One fact. ``least`` and ``most`` are those of the ICD, ``holds`` is the most that generated code has room for."""

    name: str
    kind: Kind
    key: str  # of the ICD, with dots from the section on; empty: it follows from other keys
    about: str  # what it means, beginning in lower case
    least: int = 0
    most: int | None = None
    holds: int = U32
    default: object = REQUIRED
    factor: int = 1  # how many of its unit one of the ICD is
    words: tuple[object, ...] = ()  # of a flag: what the ICD says for false and for true
    listed: str = ""  # of a flag that is set if the ICD's list has this entry
    key_about: str = ""  # what the key means, where that is something else
    direction: str = ""  # of a step: telecommand or telemetry

    @property
    def is_optional(self) -> bool:
        """Whether it may be unknown."""
        return self.default is None

    @property
    def meaning(self) -> str:
        """What it means, with its unit."""
        return f"{self.about}, in milliseconds" if self.kind is Kind.TIME else self.about

    def given(self, section: Mapping[str, Any]) -> object:
        """What the ICD says, None if it says nothing."""
        found: Any = section
        for part in self.key.split("."):
            found = found.get(part) if isinstance(found, Mapping) else None
        return found

    def read(self, section: Mapping[str, Any], known: Mapping[str, object]) -> object:
        """The value in a section. ``known``: the values of the facts before it, from which a default may follow."""
        found = self.given(section) if self.key else None
        if found is None:
            return self.default(known) if callable(self.default) else self.default
        if self.kind is Kind.FLAG:
            return self.listed in found if self.listed else found == self.words[1]  # type: ignore[operator]
        if self.kind is Kind.ALLOWED:
            return tuple(found)  # type: ignore[arg-type]
        return found * self.factor  # type: ignore[operator]


Default = object  # a value, None for a fact that may be unknown, or a function of the facts before


def _declare(kind: Kind, key: str, about: str, default: Default = REQUIRED, **more: Any) -> Any:
    """The field of a dataclass."""
    metadata = {"fact": (kind, key, about, default, more)}
    if default is REQUIRED or callable(default):
        return field(metadata=metadata)
    return field(default=default, metadata=metadata)


def number(
    key: str, about: str, least: int = 0, most: int | None = None, default: Default = REQUIRED, holds: int | None = None
) -> Any:
    """A number."""
    return _declare(Kind.NUMBER, key, about, default, least=least, most=most, holds=holds or most or U32)


def octets(
    key: str, about: str, least: int = 1, most: int | None = U16, default: Default = REQUIRED, holds: int | None = None
) -> Any:
    """A number of bytes, or where something stands."""
    return _declare(Kind.SIZE, key, about, default, least=least, most=most, holds=holds or most or U32)


def time(key: str, about: str, default: Default = REQUIRED) -> Any:
    """A time; the end of the key, ``_ms`` or ``_s``, is its unit."""
    if key.endswith("_s"):
        return _declare(Kind.TIME, key, about, default, least=0, most=MOST_MS // 1000, factor=1000)
    return _declare(Kind.TIME, key, about, default, least=1, most=MOST_MS)


def octet(key: str, about: str, default: Default = REQUIRED) -> Any:
    """A byte on the wire."""
    return _declare(Kind.OCTET, key, about, default, most=BYTE, holds=BYTE)


def code(key: str, about: str, default: Default = REQUIRED) -> Any:
    """A number of up to 32 bits whose bits matter."""
    return _declare(Kind.CODE, key, about, default)


def flag(
    key: str,
    about: str,
    default: Default = REQUIRED,
    words: tuple[object, ...] = (False, True),
    listed: str = "",
    key_about: str = "",
) -> Any:
    """A truth value: ``words`` are what the ICD says for false and for true; with ``listed``, the entries of its list."""
    return _declare(Kind.FLAG, key, about, default, words=words, listed=listed, key_about=key_about)


def allowed(key: str, about: str, key_about: str) -> Any:
    """Bytes of which one is chosen; none: all can be."""
    return _declare(Kind.ALLOWED, key, about, (), key_about=key_about)


def buses(key: str, about: str) -> Any:
    """Some of UART, I2C and CAN, which code reads under the key."""
    return _declare(Kind.BUSES, key, about)


def span(about: str) -> Any:
    """Where bytes stand, and how many they are."""
    return _declare(Kind.SPAN, "", about)


def telecommand(key: str, about: str) -> Any:
    """A telecommand that plays a part in a procedure."""
    return _declare(Kind.STEP, key, about, direction="telecommand")


def telemetry(key: str, about: str) -> Any:
    """A frame that plays a part in a procedure."""
    return _declare(Kind.STEP, key, about, direction="telemetry")


def facts_of(part: Any) -> tuple[Fact, ...]:
    """The facts that a dataclass, or one of its objects, declares, in order. What it holds beside them is made by code."""
    return _facts(part if isinstance(part, type) else type(part))


@cache
def _facts(part: Hashable) -> tuple[Fact, ...]:
    assert isinstance(part, type)
    found = ((one.name, *one.metadata["fact"]) for one in fields(part) if "fact" in one.metadata)
    return tuple(Fact(name, kind, key, about, default=it, **more) for name, kind, key, about, it, more in found)


def read(
    part: type[Any], section: Mapping[str, Any], step: Callable[[Fact], object] | None = None, **made: object
) -> Any:
    """A part read from its section, None if that lacks what has no default.

    ``step`` finds the message of a step. ``made``: what code made of other keys.
    """
    values = dict(made)
    for fact in facts_of(part):
        if fact.name in values:
            continue
        value = step(fact) if fact.kind is Kind.STEP and step else fact.read(section, values)
        if value is REQUIRED or (value is None and fact.kind is Kind.STEP):
            return None
        values[fact.name] = value
    return part(**values)

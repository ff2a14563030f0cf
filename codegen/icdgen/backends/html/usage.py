"""How a message is used in C, Python and Rust, with the names that the backends give."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from icdgen.backends.c.names import enumerator, stem
from icdgen.backends.rust import CRATE
from icdgen.backends.rust.names import field_name
from icdgen.describe import MessageDescription
from icdgen.describe.examples import worth_showing
from icdgen.naming import camel

if TYPE_CHECKING:
    from icdgen.render import Renderer

_PACKAGE = "icdgen_messages"
_ZEROS = {"bool": "false", "float": "0.0"}
_LANGUAGES = (("C", "c", "usage.c.j2"), ("Python", "python", "usage.py.j2"), ("Rust", "rust", "usage.rs.j2"))


class Snippet(NamedTuple):
    """A piece of a program; ``text`` is what a highlighter would want: code with comments."""

    language: str
    key: str
    text: str


def snippets(message: MessageDescription, render: Renderer) -> list[Snippet]:
    """One for each language: receiving, sending, or both."""
    field = worth_showing(message)
    enum = field.enum if field else None
    member = enum.members[-1] if enum and enum.members else None
    shown = {
        "m": message,
        "is_sent": message.model.telecommand_id is not None,
        "is_received": message.model.telemetry_id is not None,
        "stem": stem(message),
        "type": camel(message.words),
        "package": _PACKAGE,
        "crate": CRATE,
        "field": field,
        "rust_field": field_name(field) if field else "",
        "zero": _ZEROS.get(field.model.type, "0") if field else "",
        "member": member,
        "enumerator": enumerator(enum, member) if enum and member else "",
        "enum_type": camel(enum.words) if enum else "",
        "member_type": camel(member.words) if member else "",
    }
    return [Snippet(name, key, render(template, **shown).rstrip("\n")) for name, key, template in _LANGUAGES]


def names(message: MessageDescription) -> list[tuple[str, str]]:
    """Language and the name of the message's type in it."""
    return [("C", f"{stem(message)}_t"), ("Python", camel(message.words)), ("Rust", camel(message.words))]

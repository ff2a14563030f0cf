"""Use of a message in C, Python and Rust, with the names of the backends.

A snippet shows one field of the message. The tests of the site compile and run the
snippets, so they must be complete statements.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from icdgen.backends.c.names import enumerator, stem
from icdgen.backends.c.symbols import C_NAMES
from icdgen.backends.packages import Packages
from icdgen.backends.rust.names import field_name
from icdgen.describe import MessageDescription
from icdgen.describe.examples import field_of_example
from icdgen.frozen import NamedTuple

if TYPE_CHECKING:
    from icdgen.render import Renderer

_ZEROS = {"bool": "false", "float": "0.0"}
_LANGUAGES = (
    ("C", "c", "usage.c.j2"),
    ("Python", "python", "usage.py.j2"),
    ("Rust", "rust", "usage.rs.j2"),
)


class Snippet(NamedTuple):
    """Piece of a program.

    ``text`` is code with comments.
    """

    language: str
    key: str
    text: str


def snippets(
    message: MessageDescription,
    in_c: MessageDescription,
    packages: Packages,
    render: Renderer,
) -> list[Snippet]:
    """Return a snippet for each language: reception, transmission, or both.

    ``in_c``: message with the C prefix of its node.
    """
    # Only names in C have the prefix of the project.
    of_c = _template_values(in_c, packages)
    of_other_languages = _template_values(message, packages)
    return [
        Snippet(
            name,
            key,
            render(template, **(of_c if key == "c" else of_other_languages)).rstrip(
                "\n"
            ),
        )
        for name, key, template in _LANGUAGES
    ]


def _template_values(
    message: MessageDescription, packages: Packages
) -> dict[str, object]:
    field = field_of_example(message)
    enum = field.enum if field else None
    # The first member is often 0, which looks like the initial value.
    member = enum.members[-1] if enum and enum.members else None
    return {
        "m": message,
        "is_sent": message.model.telecommand_id is not None,
        "is_received": message.model.telemetry_id is not None,
        "stem": stem(message),
        "type": message.camel_name,
        "package": packages.python,
        "crate": packages.rust,
        "field": field,
        "rust_field": field_name(field) if field else "",
        "zero": _ZEROS.get(field.model.type, "0") if field else "",
        "member": member,
        "enumerator": enumerator(enum, member) if enum and member else "",
        "enum_type": enum.camel_name if enum else "",
        "member_type": member.camel_name if member else "",
    }


def type_names(
    message: MessageDescription, in_c: MessageDescription
) -> list[tuple[str, str]]:
    """Return the name of the message's type in each language."""
    return [
        ("C", C_NAMES.symbol(in_c, "t")),
        ("Python", message.camel_name),
        ("Rust", message.camel_name),
    ]

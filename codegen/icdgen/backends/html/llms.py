"""File ``llms.txt``: the site as one page of Markdown, for language models.

The format is described at https://llmstxt.org: a heading, a summary, and lists of
links.
"""

from __future__ import annotations

import re

from icdgen.backends.html import texts
from icdgen.backends.html.links import CHANGES, ERRATA, UNITS
from icdgen.backends.html.relations import Relations, document
from icdgen.describe.numbers import length_text


def text(relations: Relations, compared: bool) -> str:
    """Return nodes and messages with ids, length and links to their pages."""
    icd, links = relations.icd, relations.links
    lines = ["# Interface control documents", ""]
    lines += [
        f"> {_line(', '.join(node.title for node in icd.nodes))}: telecommands, telemetry and enumerations, bit by bit.",
        "",
    ]
    lines += [
        "`icd.json` holds everything that these pages show, in one file. Offsets count bits from the start of a frame.",
        "",
    ]
    for node in icd.nodes:
        about = " ".join(
            filter(None, (node.summary, document(node) + "." if node.document else ""))
        )
        lines += [f"## {_line(node.title)}", "", *([_line(about), ""] if about else [])]
        lines += [f"- [Overview]({links.node(node.name)})"]
        for message in node.messages:
            ids = "/".join(id.text for id in relations.ids(message))
            about = f"{message.kind} {ids}, {length_text(message)}. {message.summary}".rstrip()
            lines.append(
                f"- [{_line(message.name)}]({links.message(message)}): {_line(about)}"
            )
        lines += [
            f"- [{_line(enum.name)}]({links.enum(enum)}): enumeration"
            for enum in node.enums
        ]
        lines.append("")
    lines += [
        "## Further",
        "",
        f"- [Errata]({ERRATA})",
        f"- [Units and types]({UNITS})",
    ]
    lines += [f"- [What changed]({CHANGES})"] if compared else []
    return "\n".join([*lines, "- [Everything as JSON](icd.json)", ""])


def _line(text: str) -> str:
    """Return a text as one line of Markdown with escaped markup."""
    return re.sub(r"([\\`*_\[\]<>])", r"\\\1", " ".join(texts.clip(text, 400).split()))

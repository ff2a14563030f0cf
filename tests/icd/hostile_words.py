"""An ICD in which every text is markup or a command of some documentation tool."""

from __future__ import annotations

import json
from pathlib import Path

WORDS = (
    "<img src=x onerror=y>", "<b>never closed", "</p>", r"\param x", r"@return it", r"\unknowncommand", r"C:\new\file",
    "*bold* and **more**", "_it_ and trailing_", "`code", "[a](b) and [c][d] and [e]", "|sub|", "- item", "1. item", "+ item",
    "&amp; &lt;", "> quoted", "# head", ":field: x", ".. note:: x", ">>> doctest", "#link %s", "~~~", "<!-- x", "*/ /* // ??/",
    '"""', "'''", "$x$", "::",
    r"\f$ x", "@endcode", "<tt>", "https://x.example/a_b", "-", "a - b", "{x}", "\\", "x < y > z", "* star",
)  # fmt: skip


def tree() -> dict:
    """Return an ICD with each word as name, summary, meaning and title; at the start,
    in the middle and at the end.
    """
    fields = [
        {
            "at": 8 * number, "bits": 8, "name": word, "identifier": f"field {number}", "type": "uint", "unit": "x<",
            "formula": "raw*0.5 - 3", "summary": f"{word} {word} in the middle {word}",
            "special": [{"value": 7, "meaning": word}], "max": 50,
        }
        for number, word in enumerate(WORDS)
    ]  # fmt: skip
    members = [
        {
            "value": number,
            "name": word,
            "identifier": f"value {number}",
            "summary": word,
        }
        for number, word in enumerate(WORDS)
    ]
    mode = {
        "at": 8 * len(fields),
        "bits": 8,
        "name": "mode",
        "type": "enum",
        "enum": "<i> mode",
    }
    messages = [
        {
            "name": word, "identifier": f"message {number}", "id": number, "kind": "telemetry", "length": 1,
            "summary": f"{word} {word}",
            "fields": [{"at": 0, "bits": 8, "name": word, "identifier": "it", "type": "uint", "summary": word}],
        }
        for number, word in enumerate(WORDS)
    ]  # fmt: skip
    combined = {
        "name": "all", "id": 200, "kind": "telemetry", "length": len(fields) + 1, "fields": [*fields, mode],
        "summary": " ".join(WORDS) * 3,
    }  # fmt: skip
    return {
        "icdgen": 1,
        "node": {
            "name": "hostile", "title": r"<b> \title @x", "summary": r"<img x> \y", "byte_order": "little", "bit_order": "lsb0",
        },
        "units": [{"symbol": "x<", "identifier": "x", "quantity": "<q> \\z"}],
        "enums": [{"name": "<i> mode", "identifier": "mode", "members": members, "summary": " ".join(WORDS)}],
        "messages": [*messages, combined],
    }  # fmt: skip


def write(folder: Path) -> Path:
    """Write the ICD into the folder."""
    path = folder / "hostile.yaml"
    path.write_text(json.dumps(tree()))
    return path

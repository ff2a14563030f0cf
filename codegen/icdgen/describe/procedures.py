"""Comments on procedures, for all languages.

Input is a procedure of `icdgen.protocol.procedures`. Each function returns one line of
text; the backend puts it into a comment.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from icdgen.describe.comments import sentence
from icdgen.protocol.procedures import Input, Procedure


def procedure_text(procedure: Procedure) -> str:
    """Return what a procedure does, and its place in the manual."""
    texts = (sentence(procedure.summary), source_text(procedure.source))
    return " ".join(text for text in texts if text)


def source_text(source: Mapping[str, Any]) -> str:
    """Return a place in the manual, such as ``Table 67, section 3.1.``"""
    parts = [f"{key} {source[key]}" for key in ("table", "section") if key in source]
    text = ", ".join(parts)
    return f"{text[0].upper()}{text[1:]}." if text else ""


def input_text(each: Input) -> str:
    """Return what an input is, and its range."""
    texts = [sentence(each.summary) if each.summary else ""]
    if each.is_bytes:
        texts.append(f"At most {each.most} bytes.")
    elif each.values:
        numbers = [str(value) for value in each.values]
        texts.append(f"One of {', '.join(numbers)}.")
    elif not each.is_flag:
        texts.append(f"0 to {each.most}.")
    return " ".join(text for text in texts if text)

"""Text of source files that must be UTF-8.

Read by the readers of text, CSV, Markdown and C headers.
"""

from __future__ import annotations

from pathlib import Path

from icdgen.diagnostics import Finding, Findings, Place

CODE = "IMP002"


def utf8_text(path: Path, help: str) -> str:
    """Return the text of a file, without a byte order mark.

    Raises `Findings` with the line of the first other byte.
    """
    data = path.read_bytes()
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        problem = f"byte 0x{data[error.start]:02X} is not UTF-8"
        raise Findings([Finding(CODE, problem, Place(str(path), line), help)]) from None

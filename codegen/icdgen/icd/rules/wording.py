"""Phrases that the messages of several rules share."""

from __future__ import annotations

from icdgen.diagnostics import Place, Remedy

VERBATIM = "names are the manual's, to the letter"


def line_of(other: Place, here: Place) -> str:
    """Return the line of a place: ``line 12``, or ``common.yaml:12`` if it is in
    another file than ``here``.
    """
    return (
        f"line {other.line}"
        if other.file == here.file
        else f"{other.file}:{other.line}"
    )


def of_wide_value(key: str, value: int, width: int) -> Remedy:
    """Return the help for a value of a checksum that has more bits than its ``width``."""
    # Some catalogues write a polynomial with its highest term, as 0x104C11DB7.
    if key != "polynomial" or value >> width != 1:
        return Remedy(f"correct `{key}` or `width`")
    polynomial = f"0x{value & (1 << width) - 1:0{-(-width // 4)}X}"
    return Remedy(f"write it without its highest term: {polynomial}", polynomial)

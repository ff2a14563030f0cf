"""Display format of a field in documents and tools.

It changes neither the value nor generated code.
"""

from __future__ import annotations

from typing import Any

from icdgen.frozen import dataclass

HEX, BINARY, DECIMALS, DIGITS = "hex", "binary", "decimals", "digits"
OF_BITS = (HEX, BINARY)


@dataclass(frozen=True, slots=True)
class Display:
    """Display format that the ICD declares for a field."""

    kind: str  # HEX | BINARY | DECIMALS | DIGITS
    places: int = 0  # decimals after the point, or significant digits

    @property
    def plain(self) -> str | dict[str, int]:
        """Return the value of the key `display`: ``hex``, ``{decimals: 2}``."""
        return self.kind if self.kind in OF_BITS else {self.kind: self.places}

    @property
    def words(self) -> str:
        """Return the format in words: ``displayed with 2 decimals``."""
        if self.kind == HEX:
            return "displayed in hexadecimal"
        if self.kind == BINARY:
            return "displayed in binary"
        unit = {DECIMALS: "decimal", DIGITS: "significant digit"}[self.kind]
        return f"displayed with {self.places} {unit}{'s' * (self.places != 1)}"


def display_of(value: Any) -> Display | None:
    """Return the display format of a value of the key `display`; None if the value is
    absent or invalid.
    """
    if value in OF_BITS:
        return Display(value)
    items = value.items() if isinstance(value, dict) else ()
    for kind, places in items:
        if kind in (DECIMALS, DIGITS) and isinstance(places, int):
            return Display(kind, places)
    return None

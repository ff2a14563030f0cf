"""Types that only annotations use."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, TypeVar, Union

if TYPE_CHECKING:
    from typing_extensions import TypeVar as TypeVarWithDefault

    N = TypeVarWithDefault("N", default=Any)
else:
    N = TypeVar("N")

Buffer = Union[bytes, bytearray, memoryview]
"""Types of a frame."""

Frames = Union[Buffer, Iterable[Buffer]]
"""Several frames: consecutive in one buffer, or a list."""

Derivation = tuple[tuple[str, ...], tuple[float, ...], tuple[tuple[str, int, int], ...]]
"""Attributes, numbers and steps of a derived value: see `_derived`."""

Curve = tuple[tuple[float, tuple[float, ...]], ...]
"""Pieces of a calibration, each with its first raw value and coefficients: see
`_curves`.
"""

T = TypeVar("T")

Candidate = tuple[str, range, tuple[tuple[int, int, int], ...]]
"""One of several messages with an id: name, lengths, and byte, mask and value of
constants.
"""

Known = Union[str, tuple[Candidate, ...]]
"""The message of an id, or its candidates if several share it."""

"""Types that annotations name; nothing else needs them."""

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
"""Many frames: one after the other, or a list of them."""

Derivation = tuple[tuple[str, ...], tuple[float, ...], tuple[tuple[str, int, int], ...]]
"""Attributes, numbers, and steps on the row of their values: see `_derived`."""

Curve = tuple[tuple[float, tuple[float, ...]], ...]
"""From a raw value on, the terms of a polynomial in what is above that."""

T = TypeVar("T")

Candidate = tuple[str, range, tuple[tuple[int, int, int], ...]]
"""A message of an id that several have: its name, its lengths, and byte, mask and value of its constants."""

Known = Union[str, tuple[Candidate, ...]]
"""The message of an id, or its candidates if several share it."""

"""Types that annotations name; nothing else needs them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, TypeVar, Union

if TYPE_CHECKING:
    from ._base import Message

Buffer = Union[bytes, bytearray, memoryview]
"""What a frame may be given as."""

Frames = Union[Buffer, Iterable[Buffer]]
"""Many frames: one after the other, or a list of them."""

M = TypeVar("M", bound="Message")
T = TypeVar("T")

Candidate = tuple[str, int, tuple[tuple[int, int, int], ...]]
"""A message of an id that several have: its name, its length, and byte, mask and value of its constants."""

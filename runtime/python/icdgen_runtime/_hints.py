"""Types that annotations name; nothing else needs them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, Union, cast

from . import _lazy

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

M = TypeVar("M", bound="_lazy.Message")
M2 = TypeVar("M2", bound="_lazy.Message")
M3 = TypeVar("M3", bound="_lazy.Message")
S = TypeVar("S", bound="_lazy.Struct")
T = TypeVar("T")
M_co = TypeVar("M_co", covariant=True)
N_contra = TypeVar("N_contra", contravariant=True)


class SpokenBy(Protocol[N_contra]):
    """A message that a node speaks, its own or one of a node that it includes."""

    def to_bytes(self) -> bytes: ...

    def _spoken_by(self, node: N_contra, /) -> None: ...


class KindOf(Protocol[N_contra, M_co]):
    """The class of such a message."""

    def __call__(self) -> object: ...

    def _made(self) -> M_co: ...

    def _spoken_by(self, node: N_contra, /) -> None: ...


def class_of(message: KindOf[Any, M]) -> type[M]:
    """The class that it is."""
    return cast("type[M]", message)


def message_of(message: SpokenBy[Any]) -> _lazy.Message:
    """The message that it is."""
    return cast("_lazy.Message", message)


Candidate = tuple[str, range, tuple[tuple[int, int, int], ...]]
"""A message of an id that several have: its name, its lengths, and byte, mask and value of its constants."""

Known = Union[str, tuple[Candidate, ...]]
"""The message of an id, or its candidates if several share it."""

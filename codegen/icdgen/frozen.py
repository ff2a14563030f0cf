"""``@dataclass(frozen=True)`` at a quarter of its price: every start makes the classes of the model and of the protocol anew.

They are frozen for whoever checks types, and not while Python runs, where most of the time would go into writing methods that
refuse what mypy has refused already. All classes compare, hash and show themselves by the same three methods.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from operator import attrgetter
from typing import TYPE_CHECKING, Any

__all__ = ["dataclass", "rare"]

if TYPE_CHECKING:
    from dataclasses import dataclass
    from dataclasses import dataclass as rare
else:

    def dataclass(
        *, frozen: bool, eq: bool = True, repr: bool = True, **options: bool
    ) -> Callable[[type[Any]], type[Any]]:
        """For classes that are frozen; options are those of `dataclasses.dataclass`."""

        def made(plain: type[Any]) -> type[Any]:
            kind = dataclasses.dataclass(eq=False, repr=False, **options)(plain)
            if eq:
                _compare_by_value(kind)
            if repr:
                kind.__repr__ = _shown
            return kind

        return made

    def rare(*, frozen: bool, kw_only: bool = False) -> Callable[[type[Any]], type[Any]]:
        """For classes of which few objects are made, each equal to itself alone: all begin by the same method."""

        def made(plain: type[Any]) -> type[Any]:
            kind = dataclasses.dataclass(init=False, eq=False, repr=False, kw_only=kw_only)(plain)
            kind.__init__ = _begin
            return kind

        return made


def _compare_by_value(kind: type[Any]) -> None:
    compared = [one for one in dataclasses.fields(kind) if one.compare]
    value = attrgetter(*(one.name for one in compared))
    hashed = attrgetter(*(one.name for one in compared if one.hash is not False))

    def equals(self: object, other: object) -> bool:
        return value(self) == value(other) if other.__class__ is self.__class__ else NotImplemented

    def hash_value(self: object) -> int:
        return hash(hashed(self))

    kind.__eq__, kind.__hash__ = equals, hash_value  # type: ignore[assignment]


def _begin(self: Any, *given: object, **named: object) -> None:
    known = {one.name: one for one in dataclasses.fields(self)}
    positional = (name for name, one in known.items() if not one.kw_only)
    values = {**dict(zip(positional, given, strict=False)), **named}
    is_clear = len(values) == len(given) + len(named)
    for name, one in known.items():
        if name not in values and one.default_factory is not dataclasses.MISSING:
            values[name] = one.default_factory()
        elif name not in values and one.default is not dataclasses.MISSING:
            values[name] = one.default
    if not is_clear or values.keys() != known.keys():
        raise TypeError(f"{type(self).__qualname__} is made of {', '.join(known)}")
    self.__dict__.update(values)


def _shown(one: Any) -> str:
    values = (f"{each.name}={getattr(one, each.name)!r}" for each in dataclasses.fields(one) if each.repr)
    return f"{type(one).__qualname__}({', '.join(values)})"

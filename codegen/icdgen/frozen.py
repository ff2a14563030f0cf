"""``@dataclass(frozen=True)`` at a quarter of its price: every start makes the classes of the model and of the protocol anew.

They are frozen for whoever checks types, and not while Python runs, where most of the time would go into writing methods that
refuse what mypy has refused already. All classes compare, hash and show themselves by the same three methods.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from operator import attrgetter
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
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


def _compare_by_value(kind: type[Any]) -> None:
    compared = [one for one in dataclasses.fields(kind) if one.compare]
    value = attrgetter(*(one.name for one in compared))
    hashed = attrgetter(*(one.name for one in compared if one.hash is not False))

    def equals(self: object, other: object) -> bool:
        return value(self) == value(other) if other.__class__ is self.__class__ else NotImplemented

    def hash_value(self: object) -> int:
        return hash(hashed(self))

    kind.__eq__, kind.__hash__ = equals, hash_value  # type: ignore[assignment]


def _shown(one: Any) -> str:
    values = (f"{each.name}={getattr(one, each.name)!r}" for each in dataclasses.fields(one) if each.repr)
    return f"{type(one).__qualname__}({', '.join(values)})"

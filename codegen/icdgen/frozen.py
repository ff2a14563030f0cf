"""``@dataclass(frozen=True)`` at a quarter of its price: every start makes the classes of the model and of the protocol anew.

They are frozen for whoever checks types, and not while Python runs, where most of the time would go into writing methods that
refuse what mypy has refused already. All classes compare, hash and show themselves by the same three methods; the one that begins
objects is written for the first of a class.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from operator import attrgetter
from typing import TYPE_CHECKING, Any

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(
        *, frozen: bool, eq: bool = True, repr: bool = True, **options: bool
    ) -> Callable[[type[Any]], type[Any]]:
        """For classes that are frozen; options are those of `dataclasses.dataclass`."""

        def made(plain: type[Any]) -> type[Any]:
            plain.__doc__ = plain.__doc__ or plain.__name__  # else the signature is worked out, to stand in place of it
            kind = dataclasses.dataclass(init=False, eq=False, repr=False, **options)(plain)
            _begin_late(kind)
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


def _begin_late(kind: type[Any]) -> None:
    """Gives the class its ``__init__`` with the first object: of many classes, a run makes none."""

    def begin(self: Any, *given: object, **named: object) -> None:
        kind.__init__ = _initialiser(kind)
        kind.__init__(self, *given, **named)

    kind.__init__ = begin


def _initialiser(kind: type[Any]) -> Callable[..., None]:
    """What `dataclasses` writes too, in three times the time that all the rest of a class takes."""
    known = sorted(dataclasses.fields(kind), key=lambda one: one.kw_only is True)
    scope: dict[str, Any] = {f"_{one.name}": one.default for one in known if one.default is not dataclasses.MISSING}
    made = {f"_{one.name}": one.default_factory for one in known if one.default_factory is not dataclasses.MISSING}
    scope |= made
    parameters, lines = ["self"], []
    for one in known:
        if one.kw_only is True and "*" not in parameters:
            parameters.append("*")
        default, name = f"_{one.name}", one.name
        parameters.append(f"{name}={default}" if default in scope else name)
        lines.append(
            f" self.{name} = " + (f"{default}() if {name} is {default} else {name}" if default in made else name)
        )
    exec(f"def __init__({', '.join(parameters)}):\n" + "\n".join(lines or [" pass"]), scope)
    initialiser: Callable[..., None] = scope["__init__"]
    return initialiser


def _shown(one: Any) -> str:
    values = (f"{each.name}={getattr(one, each.name)!r}" for each in dataclasses.fields(one) if each.repr)
    return f"{type(one).__qualname__}({', '.join(values)})"

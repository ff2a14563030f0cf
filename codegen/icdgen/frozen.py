"""Replacements of ``@dataclass(frozen=True)`` and of ``NamedTuple`` that create classes
in a quarter and in half of the time.

Every start creates the classes of the model and of the protocol. Type checkers see
`dataclass` and `NamedTuple` of the standard library instead.

At run time, classes of `dataclass` are not frozen, because `dataclasses` would spend
most of the time on generating methods that reject assignments, which mypy rejects
already. All classes share the implementation of comparison, hash and repr. ``__init__``
is generated with the first object of a class.

`typing` compiles the annotation of each field of a named tuple, which nothing reads.
`NamedTuple` leaves that out.
"""

from __future__ import annotations

import dataclasses
from collections import namedtuple
from collections.abc import Callable
from operator import attrgetter
from typing import TYPE_CHECKING, Any

__all__ = ["NamedTuple", "dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
    from typing import NamedTuple
else:

    class _OfNamedTuples(type):
        """Metaclass that turns the subclasses of `NamedTuple` into named tuples."""

        def __new__(
            cls, name: str, bases: tuple[type[Any], ...], body: dict[str, Any]
        ) -> type[Any]:
            if not bases:  # `NamedTuple` itself
                return super().__new__(cls, name, bases, body)
            fields = body.get("__annotations__", {})
            defaults = [body[field] for field in fields if field in body]
            kind = namedtuple(
                name, fields, defaults=defaults, module=body["__module__"]
            )
            for attribute, value in body.items():
                if attribute not in fields:
                    setattr(kind, attribute, value)
            return kind

    class NamedTuple(metaclass=_OfNamedTuples):
        """Base class of named tuples, used as `typing.NamedTuple`."""

    def dataclass(
        *, frozen: bool, eq: bool = True, repr: bool = True, **options: bool
    ) -> Callable[[type[Any]], type[Any]]:
        """Return a decorator for frozen classes, with the options of
        `dataclasses.dataclass`.
        """

        def decorate(plain: type[Any]) -> type[Any]:
            # Without a docstring, `dataclasses` would compute the signature, which is
            # slow.
            plain.__doc__ = plain.__doc__ or plain.__name__
            kind = dataclasses.dataclass(init=False, eq=False, repr=False, **options)(
                plain
            )
            _begin_late(kind)
            if eq:
                _compare_by_value(kind)
            if repr:
                kind.__repr__ = _shown
            return kind

        return decorate


def _compare_by_value(kind: type[Any]) -> None:
    """Give a class ``__eq__`` and ``__hash__`` over its fields."""
    compared = [field for field in dataclasses.fields(kind) if field.compare]
    value = attrgetter(*(field.name for field in compared))
    # As in `dataclasses`: `hash=None` means that the field is hashed if it is compared.
    hashed = attrgetter(*(field.name for field in compared if field.hash is not False))

    def equals(self: object, other: object) -> bool:
        return (
            value(self) == value(other)
            if other.__class__ is self.__class__
            else NotImplemented
        )

    def hash_value(self: object) -> int:
        return hash(hashed(self))

    kind.__eq__, kind.__hash__ = equals, hash_value  # type: ignore[assignment]


def _begin_late(kind: type[Any]) -> None:
    """Give a class an ``__init__`` that generates the real one on the first call: a run
    uses few of the classes.
    """

    def begin(self: Any, *positional: object, **keywords: object) -> None:
        kind.__init__ = _initialiser(kind)
        kind.__init__(self, *positional, **keywords)

    kind.__init__ = begin


def _initialiser(kind: type[Any]) -> Callable[..., None]:
    """Return the ``__init__`` of a class, equivalent to the one that `dataclasses`
    generates.
    """
    # As in `dataclasses`, keyword-only parameters follow all others: an inherited one
    # can be in front of a positional one. The sort is stable.
    fields = sorted(dataclasses.fields(kind), key=lambda field: field.kw_only is True)
    # Default or factory of each field, by its name with a leading underscore.
    scope: dict[str, Any] = {}
    factories: set[str] = set()
    parameters, lines = ["self"], []
    for field in fields:
        name, default = field.name, f"_{field.name}"
        if field.default is not dataclasses.MISSING:
            scope[default] = field.default
        elif field.default_factory is not dataclasses.MISSING:
            scope[default] = field.default_factory
            factories.add(default)
        if field.kw_only is True and "*" not in parameters:
            parameters.append("*")
        parameters.append(f"{name}={default}" if default in scope else name)
        # A factory is its own default: no caller passes it, so the identity test shows
        # that the argument is missing.
        value = (
            f"{default}() if {name} is {default} else {name}"
            if default in factories
            else name
        )
        lines.append(f" self.{name} = {value}")
    exec(
        f"def __init__({', '.join(parameters)}):\n" + "\n".join(lines or [" pass"]),
        scope,
    )
    initialiser: Callable[..., None] = scope["__init__"]
    return initialiser


def _shown(instance: Any) -> str:
    """Return the repr of an object, as `dataclasses` does."""
    fields = dataclasses.fields(instance)
    values = (
        f"{field.name}={getattr(instance, field.name)!r}"
        for field in fields
        if field.repr
    )
    return f"{type(instance).__qualname__}({', '.join(values)})"

"""Cached values of objects.

`cached_property` is without the lock of `functools` before Python 3.12, which is slow.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar

Owner = TypeVar("Owner")
Result = TypeVar("Result")

if TYPE_CHECKING or sys.version_info >= (3, 12):
    from functools import cached_property as cached_property
else:

    class cached_property:
        """An attribute that is computed on the first access."""

        def __init__(self, function: Any) -> None:
            self.function, self.__doc__ = function, function.__doc__

        def __set_name__(self, owner: type[Any], name: str) -> None:
            self.name = name

        def __get__(self, instance: Any, owner: type[Any] | None = None) -> Any:
            if instance is None:
                return self
            # Python reads the value from __dict__ from now on, without calling __get__.
            value = instance.__dict__[self.name] = self.function(instance)
            return value


def cached_by_owner(function: Callable[[Owner], Result]) -> Callable[[Owner], Result]:
    """Decorate a function of one object so that its result is cached in the
    ``__dict__`` of the object.
    """
    name = f"_{function.__name__}"

    @wraps(function)
    def look_up(owner: Owner) -> Result:
        values = owner.__dict__
        if name not in values:
            values[name] = function(owner)
        result: Result = values[name]
        return result

    return look_up

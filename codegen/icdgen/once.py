"""`functools.cached_property` without the lock that Python before 3.12 takes for each value: a run works out thousands."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING or sys.version_info >= (3, 12):
    from functools import cached_property as cached_property
else:

    class cached_property:
        """An attribute that is worked out when it is first asked for."""

        def __init__(self, function: Any) -> None:
            self.function, self.__doc__ = function, function.__doc__

        def __set_name__(self, owner: type[Any], name: str) -> None:
            self.name = name

        def __get__(self, one: Any, owner: type[Any] | None = None) -> Any:
            if one is None:
                return self
            value = one.__dict__[self.name] = self.function(one)
            return value

"""Loads types when they are first used: importing a node costs next to nothing."""

from __future__ import annotations

from importlib import import_module

from ._errors import UnknownIdError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from ._base import Message


def attribute(module: dict[str, Any], homes: dict[str, str], name: str) -> Any:
    """The class ``name`` of the node ``module``, from the file that ``homes`` gives."""
    if name not in homes:
        raise AttributeError(f"module {module['__name__']!r} has no attribute {name!r}")
    home = import_module(homes[name], module["__name__"])
    module[name] = value = getattr(home, name)
    return value


class Messages:
    """The messages of a node by id: ``TELEMETRY[146]`` is a class."""

    def __init__(
        self, module: dict[str, Any], node: str, kind: str, names: dict[int, str]
    ) -> None:
        self._module, self._node, self._kind, self._names = module, node, kind, names
        self._loaded: dict[int, type[Message]] = {}

    def __getitem__(self, id: int) -> type[Message]:
        try:
            return self._loaded[id]
        except (KeyError, TypeError):
            return self._load(id)

    def _load(self, id: int) -> type[Message]:
        if not isinstance(id, int) or id not in self._names:
            raise UnknownIdError(self._node, self._kind, id)
        name = self._names[id]
        message: type[Message] = attribute(self._module, self._module["_HOMES"], name)
        self._loaded[id] = message
        return message

    def __contains__(self, id: object) -> bool:
        return isinstance(id, int) and id in self._names

    def __iter__(self) -> Iterator[int]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def items(self) -> Iterator[tuple[int, type[Message]]]:
        """All ids and classes; loads them."""
        return ((id, self[id]) for id in self._names)

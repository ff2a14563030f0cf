"""Import on first use, so that importing a node is fast.

The classes of a node are in several modules. A module is imported when one of its
classes is used by name (`attribute`) or by id (`Messages`).
"""

from __future__ import annotations

from importlib import import_module

# The module, not its names: these are imported when an annotation is evaluated.
from . import _lazy  # noqa: PLW0406
from ._errors import UnknownIdError

__all__ = [
    "Any",
    "Buffer",
    "Candidate",
    "Iterator",
    "Known",
    "Mapping",
    "Message",
    "Messages",
    "Optional",
    "attribute",
]

# Type checkers treat this name as true. Importing `typing` would slow down the start.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from typing import Any, Optional

    from ._base import Message
    from ._hints import Buffer, Candidate, Known
else:
    _OURS = {
        "Buffer": "._hints",
        "Candidate": "._hints",
        "Known": "._hints",
        "Message": "._base",
    }

    def __getattr__(name):
        if name.startswith("_"):  # import asks for `__path__`: typing stays unloaded
            raise AttributeError(name)
        return getattr(import_module(_OURS.get(name, "typing"), __package__), name)


def attribute(
    module: dict[str, _lazy.Any], homes: dict[str, str], name: str
) -> _lazy.Any:
    """Return the class ``name`` of the node ``module``. ``homes`` gives its module."""
    if name not in homes:
        raise AttributeError(f"module {module['__name__']!r} has no attribute {name!r}")
    home = import_module(homes[name], module["__name__"])
    module[name] = value = getattr(home, name)
    return value


class Messages:
    """The messages of a node by id: ``TELEMETRY[146]`` is a class.

    For an id that several messages share, the class represents all of them. Its
    `from_bytes` returns the message that matches the frame.
    """

    def __init__(
        self,
        module: dict[str, _lazy.Any],
        node: str,
        kind: str,
        names: _lazy.Mapping[int, _lazy.Known],
    ) -> None:
        self._module, self._node, self._kind, self._names = module, node, kind, names
        self._loaded: dict[int, type[Message]] = {}

    def __getitem__(self, id: int) -> type[_lazy.Message]:
        try:
            return self._loaded[id]
        except (KeyError, TypeError):
            return self._load(id)

    def _load(self, id: int) -> type[_lazy.Message]:
        if not isinstance(id, int) or id not in self._names:
            raise UnknownIdError(self._node, self._kind, id)
        names = self._names[id]
        if isinstance(names, str):
            message = self._named(names)
        else:
            from ._shared import shared

            message = shared(self._node, self._kind, id, names, self._named)
        self._loaded[id] = message
        return message

    def _named(self, name: str) -> type[_lazy.Message]:
        message: type[Message] = attribute(self._module, self._module["_HOMES"], name)
        return message

    def of(self, id: int) -> tuple[type[_lazy.Message], ...]:
        """Return all messages of an id, several if they share it.

        Raise `UnknownIdError`.
        """
        entry: _lazy.Any = self[id]
        return tuple(message for message, _, _ in getattr(entry, "FRAMES", ())) or (
            entry,
        )

    def which(self, id: int, frame: bytes) -> _lazy.Optional[type[_lazy.Message]]:
        """Return the message of an id that a frame matches, or None."""
        entry: _lazy.Any = self[id]
        message: _lazy.Optional[type[Message]]
        message = entry.which(frame) if hasattr(entry, "FRAMES") else entry
        return message

    def __contains__(self, id: object) -> bool:
        return isinstance(id, int) and id in self._names

    def __iter__(self) -> _lazy.Iterator[int]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def items(self) -> _lazy.Iterator[tuple[int, type[_lazy.Message]]]:
        """Iterate over all ids and classes. This imports all messages."""
        return ((id, self[id]) for id in self._names)

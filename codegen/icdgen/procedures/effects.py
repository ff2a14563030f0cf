"""Effects of procedures in the device: the objects that they read and change.

An object is a sequence of bytes, such as a file or a program. It has a kind, and a key
of numbers that identifies it within its kind.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from icdgen.protocol.procedures import Effect, Procedure, Send

Key = tuple[int, ...]


@dataclass
class Object:
    """Object of the device. ``time`` is packed."""

    data: bytearray
    time: int = 0


@dataclass
class Objects:
    """Objects of the device by kind and key, in order of creation.

    ``computed``: function that returns the content of an object that the device
    computes from other objects; None for any other object. ``on_write`` is called when
    an object, or a block of it, is complete.
    """

    kinds: dict[str, dict[Key, Object]] = field(default_factory=dict)
    computed: Callable[[str, Key], bytes | None] | None = None
    on_write: Callable[[str, Key, bytes], None] | None = None

    def objects_of(self, kind: str) -> dict[Key, Object]:
        """Return the objects of a kind."""
        return self.kinds.setdefault(kind, {})

    def content_of(self, kind: str, key: Key) -> bytes | None:
        """Return the content of an object; None if there is no such object."""
        computed = self.computed(kind, key) if self.computed else None
        if computed is not None:
            return computed
        stored = self.objects_of(kind).get(key)
        return None if stored is None else bytes(stored.data)

    def put(self, kind: str, key: Key, data: bytes) -> None:
        """Store an object. Replace an object that has this key."""
        self.objects_of(kind)[key] = Object(bytearray(data))

    def patch(self, kind: str, key: Key, offset: int, data: bytes) -> None:
        """Store a part of an object. Bytes before it that do not exist yet are 0."""
        stored = self.objects_of(kind).setdefault(key, Object(bytearray()))
        # Packets that the device stores one by one leave a gap if one of them is lost.
        stored.data.extend(bytes(max(0, offset - len(stored.data))))
        stored.data[offset : offset + len(data)] = data

    def report(self, kind: str, key: Key) -> None:
        """Call ``on_write`` for an object."""
        if self.on_write:
            self.on_write(kind, key, bytes(self.objects_of(kind)[key].data))


def effect_of(procedure: Procedure) -> Effect:
    """Return the effect of a procedure from the ICD, or else the default effect."""
    return procedure.effect or default_effect(procedure)


def default_effect(procedure: Procedure) -> Effect:
    """Return the effect of a procedure if the ICD does not describe it.

    A procedure with blocks reads or writes an object of its own kind. The inputs
    that its telecommands have are the key of the object. Other procedures have no
    effect.
    """
    sent: set[int] = set()  # registers that telecommands have
    for step in procedure.steps:
        if isinstance(step, Send):
            sent |= {put.value.number for put in step.puts if put.value.in_register}
    numbers = [each.name for each in procedure.numbers]
    key = {
        register: name
        for register, name in enumerate(numbers, procedure.first_input)
        if register in sent
    }
    verb = ""
    if procedure.blocks is not None:
        verb = "write" if procedure.blocks.sends else "read"
    return Effect(verb, procedure.name, tuple(key), tuple(key.values()))

"""Messages that share an id: the length and the constants of a frame select one of
them.
"""

from __future__ import annotations

from . import _types
from ._base import Message
from ._errors import LengthError, UnknownIdError


class Shared(Message):
    """Class for all messages of an id: `from_bytes` returns the one that matches the
    frame.
    """

    FRAMES: tuple[
        tuple[type[Message], range, tuple[tuple[int, int, int], ...]], ...
    ] = ()
    """Each message with its lengths, and byte, mask and value of its constants.

    The message with the most constants is first.
    """

    def __init__(self, **values: object) -> None:
        raise TypeError(f"{self.NAME} are several messages: make one of them")

    @classmethod
    def from_bytes(cls, data: _types.Buffer) -> _types.Any:
        """Decode a frame.

        Raise `UnknownIdError` if no message matches it, or `LengthError` if all
        messages have one length and the frame has another.
        """
        frame = bytes(data)
        message = cls.which(frame)
        if message is not None:
            return message.from_bytes(frame)
        ends = ((lengths[0], lengths[-1]) for _, lengths, _ in cls.FRAMES)
        length, *further = {length for pair in ends for length in pair}
        if not further and len(frame) != length:
            raise LengthError(cls.NAME, length, len(frame))
        raise UnknownIdError(
            cls.NODE, cls.KIND, cls.IDS[0], f"the frame is no {cls.NAME}"
        )

    @classmethod
    def which(cls, frame: bytes) -> _types.Optional[type[Message]]:
        """Return the message that matches a frame, or None."""
        for message, lengths, signs in cls.FRAMES:
            longest = frame.ljust(lengths[-1], b"\0")
            if len(frame) in lengths and all(
                longest[byte] & mask == value for byte, mask, value in signs
            ):
                return message
        return None


def shared(
    node: str,
    kind: str,
    id: int,
    candidates: tuple[_types.Candidate, ...],
    named: _types.Callable[[str], type[Message]],
) -> type[Message]:
    """Return the class for an id that several messages share."""
    frames = tuple((named(name), lengths, signs) for name, lengths, signs in candidates)
    title = " or ".join(message.NAME for message, _, _ in frames)
    namespace = {
        "NODE": node,
        "NAME": title,
        "KIND": kind,
        "IDS": (id,),
        "FRAMES": frames,
    }
    return type("Shared", (Shared,), namespace)

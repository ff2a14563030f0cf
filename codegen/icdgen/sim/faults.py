"""Simulated transmission faults, from a random seed."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from random import Random

from icdgen.errors import UserError

OUT = ("acknowledge", "reply", "packet", "log", "telemetry")  # what the device sends
IN = ("telecommand", "request", "upload")  # what it receives
KINDS = {
    "drop": "the message is lost",
    "corrupt": "one of its bytes becomes another one",
    "cut": "one of its bytes is lost",
    "duplicate": "it comes twice",
    "repeat": "one of its bytes comes twice",
    "late": "it comes later",
    "noise": "bytes that mean nothing come before it",
    "nack": "the telecommand is refused",
}
_SPEC = re.compile(r"(?P<kind>[a-z]+)=(?P<share>[0-9.]+%?)(?:@(?P<on>[a-z,]+))?")


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault of the share ``share`` (0 to 1) of messages of the kinds ``on``."""

    kind: str
    share: float
    on: tuple[str, ...]


@dataclass
class Faults:
    """Active faults. ``late_ms`` is the maximum delay."""

    random: Random
    faults: list[Fault] = field(default_factory=list)
    late_ms: int = 1500

    def hits(self, kind: str, on: str) -> bool:
        """Return whether this message has the fault."""
        return any(
            f.kind == kind and on in f.on and self.random.random() < f.share
            for f in self.faults
        )

    def apply(self, on: str, data: bytes) -> list[tuple[int, bytes]]:
        """Return the bytes of a message with faults: pieces and their delays in
        milliseconds.
        """
        if self.hits("drop", on):
            return []
        out = bytearray(data)
        if out and self.hits(
            "corrupt", on
        ):  # XOR with 1 to 255 always changes the byte
            out[self.random.randrange(len(out))] ^= self.random.randrange(1, 256)
        if out and self.hits("cut", on):
            del out[self.random.randrange(len(out))]
        if out and self.hits("repeat", on):
            at = self.random.randrange(len(out))
            out.insert(at, out[at])
        if self.hits("noise", on):
            out[:0] = self.random.randbytes(self.random.randrange(1, 32))
        pieces = [bytes(out)] * (2 if self.hits("duplicate", on) else 1)
        return [(self._delay(on), piece) for piece in pieces]

    def _delay(self, on: str) -> int:
        """Return the delay of a piece in milliseconds: 0 if it is not late."""
        if not self.hits("late", on):
            return 0
        return self.random.randrange(1, self.late_ms + 1)


def parse(text: str) -> Fault:
    """Return the fault of a text such as ``drop=10%@acknowledge`` or ``corrupt=0.01``.

    Raise `icdgen.errors.UserError`.
    """
    match = _SPEC.fullmatch(text.strip())
    help = f"KIND=SHARE or KIND=SHARE@WHAT, for instance drop=10%@acknowledge; kinds: {', '.join(KINDS)}"
    if match is None or match["kind"] not in KINDS:
        raise UserError(f"`{text}` is no fault", help)
    share = match["share"]
    try:
        value = float(share.rstrip("%")) / (100 if share.endswith("%") else 1)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1:
        raise UserError(f"`{text}`: the share is not between 0 and 1 (100%)", help)
    allowed = {"nack": ("telecommand",), "late": OUT}.get(match["kind"], (*OUT, *IN))
    on = (
        tuple(match["on"].split(","))
        if match["on"]
        else (allowed if match["kind"] == "nack" else OUT)
    )
    for kind in on:
        if kind not in allowed:
            raise UserError(
                f"`{text}`: it cannot be on `{kind}`",
                f"what it can be on: {', '.join(allowed)}",
            )
    return Fault(match["kind"], value, on)

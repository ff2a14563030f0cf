"""Simulated transmission faults, from a random seed.

`parse` reads a fault of the command line, such as ``drop=10%@acknowledge``. `Faults`
decides for each message whether it has the fault.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from random import Random

from icdgen.errors import UserError

OUT = ("acknowledge", "reply", "packet", "log", "telemetry")  # what the device sends
IN = ("telecommand", "request", "upload")  # what it receives
OUTCOMES = {
    "nak": "the telecommand is refused, with the reason after the share, if there is one",
    "busy": "the device is busy and does not execute the telecommand",
    "silence": "the telecommand is executed, and nothing responds to it",
    "foreign": "the response belongs to another telecommand",
}
"""Faults of the response to a telecommand."""
KINDS = {
    "drop": "the message is lost",
    "corrupt": "one of its bytes becomes another one",
    "cut": "one of its bytes is lost",
    "duplicate": "it comes twice",
    "repeat": "one of its bytes comes twice",
    "late": "it comes later, by the milliseconds after the share, or a random time",
    "noise": "bytes that mean nothing come before it",
    **OUTCOMES,
}
_OTHER_SPELLING = {"nack": "nak"}
_SPEC = re.compile(
    r"(?P<kind>[a-z]+)=(?P<share>[0-9.]+%?)(?::(?P<detail>[^@]+))?(?:@(?P<on>[a-z,]+))?"
)
HELP = (
    "KIND=SHARE[:DETAIL][@WHAT], for instance drop=10%@acknowledge or late=1:300; "
    f"kinds: {', '.join(KINDS)}"
)


@dataclass(frozen=True, slots=True)
class InjectedFault:
    """A fault of the share ``share`` (0 to 1) of messages of the kinds ``on``."""

    kind: str
    share: float
    on: tuple[str, ...]
    reason: str | None = None  # of a refusal: a member of its enumeration, or a number
    delay_ms: int | None = None  # of a late message; None: random


@dataclass
class Faults:
    """Active faults. ``late_ms`` is the maximum delay."""

    random: Random
    faults: list[InjectedFault] = field(default_factory=list)
    late_ms: int = 1500

    def hits(self, kind: str, on: str) -> bool:
        """Return whether this message has the fault."""
        return self.fault(kind, on) is not None

    def fault(self, kind: str, on: str) -> InjectedFault | None:
        """Return the fault of this kind that this message has; None without one."""
        for fault in self.faults:
            # Only a fault that applies takes a random number, so that other faults do
            # not change the effect of a seed.
            if fault.kind == kind and on in fault.on:
                if self.random.random() < fault.share:
                    return fault
        return None

    def apply(self, on: str, data: bytes) -> list[tuple[int, bytes]]:
        """Return the bytes of a message with faults: pieces and their delays in
        milliseconds.
        """
        # Each test takes random numbers. Another order would give other faults for the
        # same seed.
        if self.hits("drop", on):
            return []
        out = bytearray(data)
        # XOR with 1 to 255 always changes the byte.
        if out and self.hits("corrupt", on):
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
        fault = self.fault("late", on)
        if fault is None:
            return 0
        if fault.delay_ms is not None:
            return fault.delay_ms
        return self.random.randrange(1, self.late_ms + 1)


def parse(text: str) -> InjectedFault:
    """Return the fault of a text such as ``drop=10%@acknowledge``, ``nak=1:Bad length``
    or ``late=50%:300``.

    Raise `icdgen.errors.UserError`.
    """
    match = _SPEC.fullmatch(text.strip())
    kind = _OTHER_SPELLING.get(match["kind"], match["kind"]) if match else ""
    if match is None or kind not in KINDS:
        raise UserError(f"`{text}` is no fault", HELP)
    share = match["share"]
    try:
        value = float(share.rstrip("%")) / (100 if share.endswith("%") else 1)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1:
        raise UserError(f"`{text}`: the share is not between 0 and 1 (100%)", HELP)
    default: tuple[str, ...] = OUT
    allowed: tuple[str, ...] = (*OUT, *IN)
    if kind in OUTCOMES:
        default = allowed = ("telecommand",)
    elif kind == "late":
        allowed = OUT
    on = tuple(match["on"].split(",")) if match["on"] else default
    for what in on:
        if what not in allowed:
            raise UserError(
                f"`{text}`: it cannot be on `{what}`",
                f"what it can be on: {', '.join(allowed)}",
            )
    detail = match["detail"]
    if detail is None:
        return InjectedFault(kind, value, on)
    detail = detail.strip()
    if kind == "nak":
        return InjectedFault(kind, value, on, reason=detail)
    if kind != "late":
        help = "only nak (the reason) and late (milliseconds) have a detail"
        raise UserError(f"`{text}`: `{kind}` has no detail `{detail}`", help)
    if not (detail.isdecimal() and 0 < int(detail) < 1 << 31):
        raise UserError(
            f"`{text}`: `{detail}` is no number of milliseconds", "late=1:300"
        )
    return InjectedFault(kind, value, on, delay_ms=int(detail))

"""Requests that test the protocol layer, derived from the protocol facts of a node; one
module per subject.
"""

from collections.abc import Iterator
from random import Random
from typing import Any

Requests = Iterator[tuple[str, dict[str, Any]]]
"""Requests of the testee protocol, each with its purpose."""

Row = dict[str, Any]
"""Moment of a script of a client or a procedure."""

Script = list[Row]
"""Script of a client or a procedure."""


def pieces(
    why: str, stream: bytes, source: Random
) -> Iterator[tuple[str, list[bytes]]]:
    """Yield the stream in one piece, byte by byte, and cut at random positions."""
    yield why, [stream]
    yield f"{why}, byte by byte", [bytes([byte]) for byte in stream]
    # Cuts at the ends give empty pieces, which a decoder must accept.
    cuts = sorted(source.sample(range(len(stream) + 1), min(5, len(stream))))
    ends = zip([0, *cuts], [*cuts, len(stream)], strict=True)
    yield f"{why}, cut at odd places", [stream[begin:end] for begin, end in ends]

"""Streams of bytes for the tests of the protocol runtime."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

quick = settings(
    max_examples=60, deadline=None, suppress_health_check=list(HealthCheck)
)

# Mostly bytes with a meaning, so that streams are full of starts, ends and escapes.
MARKERS = st.sampled_from([0x1F, 0x1F, 0x1F, 0x7F, 0xFF, 0x00, 0x80, 0x92])
NOISE = st.lists(MARKERS, max_size=12).map(bytes) | st.binary(max_size=12)


def cut(data: bytes, places: list[int]) -> list[bytes]:
    """Return the pieces of a stream that is cut at these positions."""
    edges = [0, *sorted(min(place, len(data)) for place in places), len(data)]
    return [data[a:b] for a, b in pairwise(edges)]

"""The test of generated C which message a frame is: it agrees with the ICD for all
lengths, and reads only the bytes that the frame has.
"""

from __future__ import annotations

import random
import re

import pytest

from icdgen.backends.c.names import constant
from icdgen.backends.c.statement import frame_test
from icdgen.describe import describe
from icdgen.describe.nodes import MessageOfId
from tests.conformance import odd
from tests.conformance.icds import icd_of

_CHOICE = re.compile(r"\((\(length [<>]=? \d+u\)) \? (buffer\[\d+\]) : 0u\)")


def candidates() -> list[MessageOfId]:
    """Return the messages of shared ids, some of which can end early."""
    (node,) = (
        node
        for node in describe(icd_of([odd.FOLDER / "apart.yaml"])).nodes
        if node.name == "apart"
    )
    return [
        candidate
        for direction in ("telecommand", "telemetry")
        for of_id in node.ids(direction)
        if of_id.is_shared
        for candidate in of_id.messages
    ]


def in_python(test: str, candidate: MessageOfId) -> str:
    """Return a test in C as an expression of Python."""
    message = candidate.message
    test = _CHOICE.sub(r"(\2 if \1 else 0)", " ".join(test.split()))
    test = test.replace(constant(message, "length"), str(message.model.length))
    return re.sub(r"\b(\d+|0x[0-9A-F]+)u\b", r"\1", test.replace("&&", "and"))


def is_frame(candidate: MessageOfId, frame: bytes) -> bool:
    """Return whether a frame, with its omitted zeros, has the length and the constants
    of a message.
    """
    lengths = candidate.message.model.layout.lengths
    complete = frame.ljust(lengths[-1], b"\0")
    return len(frame) in lengths and all(
        complete[byte] & mask == value for byte, mask, value in candidate.constant_bytes
    )


@pytest.mark.parametrize(
    "candidate", candidates(), ids=lambda candidate: candidate.message.name
)
def test_a_frame_is_recognized_without_reading_behind_its_end(candidate):
    source = random.Random(1)
    expression = compile(in_python(frame_test(candidate), candidate), "test", "eval")
    longest = candidate.message.model.length
    accepted = set()
    for length in range(longest + 2):
        for changed in (None, *range(length)):
            frame = bytearray(source.randbytes(length))
            for byte, mask, value in candidate.constant_bytes:
                if byte < length:
                    frame[byte] = frame[byte] & ~mask | value
            if changed is not None:
                frame[changed] ^= 1 << source.randrange(8)
            # A byte behind the end raises an `IndexError`.
            result = eval(expression, {"buffer": frame, "length": length})
            assert result == is_frame(candidate, bytes(frame)), frame.hex()
            accepted.add(result)
    assert True in accepted

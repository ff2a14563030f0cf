"""Exceptions of requests and procedures: texts, attributes and copies."""

from __future__ import annotations

import pickle
from types import SimpleNamespace

import pytest
from icdgen_runtime.wire.errors import (
    ChecksumError,
    TooLongError,
    UnsupportedError,
    need,
)
from icdgen_runtime.wire.events import Busy, Refused, Timeout
from icdgen_runtime.wire.failures import (
    DeviceBusyError,
    FailedError,
    RefusedError,
    ReplyTimeoutError,
)
from icdgen_runtime.wire.identity import Identity, identify

FAILURES = [
    (RefusedError(Refused(0, 1)), "the request of id 0 was refused: no reason"),
    (RefusedError(Refused(9, 1, code=0), "Go"), "Go (id 9) was refused: 0"),
    (
        RefusedError(Refused(9, 2, code=7, reason="Not Ready"), "Go"),
        "Go (id 9) was refused: Not Ready",
    ),
    (
        DeviceBusyError(Busy(0, 1)),
        "the request of id 0: the device was still busy after 1 attempt",
    ),
    (
        DeviceBusyError(Busy(9, 2), "Go"),
        "Go (id 9): the device was still busy after 2 attempts",
    ),
    (
        ReplyTimeoutError(Timeout(0, 1)),
        "the request of id 0 had no reply after 1 attempt",
    ),
    (
        ReplyTimeoutError(Timeout(9, 2), "Go"),
        "Go (id 9) had no reply after 2 attempts",
    ),
    (FailedError("timeout"), "the procedure ended with: timeout"),
    (
        FailedError("refused", Refused(9, 1, code=0)),
        "the procedure ended with: refused: the request of id 9 was refused: 0",
    ),
    (TooLongError(8, 9), "9 bytes, at most 8 fit"),
    (ChecksumError(0x1F, 0), "the checksum is 0x0, of the data it is 0x1f"),
]


@pytest.mark.parametrize(("error", "text"), FAILURES)
def test_a_failure_names_its_request_and_survives_pickling(error, text):
    assert str(error) == text
    copied = pickle.loads(pickle.dumps(error))
    assert (type(copied), str(copied)) == (type(error), text)
    assert vars(copied) == vars(error)


def test_only_a_missing_part_of_a_link_is_unsupported():
    assert need(0, "time") == 0
    assert need("", "time") == ""
    with pytest.raises(UnsupportedError, match=r"^the ICD says nothing about `time`$"):
        need(None, "time")


@pytest.mark.parametrize(
    ("node_type", "version", "matches"),
    [
        (3, 5, True),
        (None, 5, True),
        (3, None, True),
        (None, None, True),
        (0, 5, False),  # 0 is a type like any other
        (3, 0, False),
        (5, 3, False),
    ],
)
def test_a_node_matches_if_all_numbers_in_the_icd_match(node_type, version, matches):
    frame = SimpleNamespace(kind=3, interface=5)
    link = SimpleNamespace(
        identification=SimpleNamespace(
            telemetry=0,
            fields={"node_type": "kind", "interface_version": "interface"},
        ),
        TELEMETRY={0: SimpleNamespace(from_bytes=lambda data: frame)},
        node_type=node_type,
        interface_version=version,
    )
    assert identify(link, b"") == Identity(3, 5, matches)  # type: ignore[arg-type]

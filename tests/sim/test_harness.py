"""The harness for clients of any language: it tells a good one from a bad one."""

from __future__ import annotations

import sys

import pytest

from tests.sim import harness

REFERENCE = [sys.executable, "-m", "tests.sim.client"]


@pytest.mark.parametrize(
    ("loss", "faults"),
    [
        ("0", []),
        ("30", []),
        ("10", ["late=10%@acknowledge"]),
        ("10", ["corrupt=10%@acknowledge"]),
    ],
)
def test_the_reference_client_passes(loss, faults):
    assert harness.run(REFERENCE, 5_001, loss, faults, limit=120) is None


def test_a_client_that_hangs_fails_or_lies_is_found():
    assert (
        harness.run(
            [sys.executable, "-c", "import time; time.sleep(60)"], 10, "0", [], limit=2
        )
        == "hangs"
    )
    assert "ended with 3" in harness.run(
        [sys.executable, "-c", "raise SystemExit(3)"], 10, "0", []
    )
    assert "another one" in harness.run([sys.executable, "-c", ""], 10, "0", [])


def test_a_client_that_leaves_out_telecommands_is_found():
    forgetful = """
import sys
from tests.sim import client
reset = next(m for m in client.ICD.messages_of(client.STARTER) if m.name == "Reset")
data = client.codec.encode(client.STARTER, reset, client.allowed_values(client.ICD, reset))
client.every_telecommand = lambda session: client.reset(session, reset, data)
client.main(*sys.argv[1:])
"""
    found = harness.run([sys.executable, "-c", forgetful], 10, "0", [])
    assert (
        found.startswith("never sent: ")
        and "Reset," not in found
        and "Save Image" in found
        and "Hole Map" not in found
    )

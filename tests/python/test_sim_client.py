"""A program over the generated package, against the simulator, over TCP: every message,
files both ways, losses and faults.

``PYTHONPATH=generated/python python -m tests.sim.harness -- python -m
tests.python.sim_client`` runs it with a megabyte.
"""

from __future__ import annotations

import os
import sys

import pytest

from tests.conftest import ROOT
from tests.sim import harness

CLIENT = [sys.executable, "-m", "tests.python.sim_client"]
SIZE = 65_537  # the last block is of another length, its last packet of one byte


@pytest.fixture(autouse=True)
def path(monkeypatch):
    before = os.environ.get("PYTHONPATH")
    monkeypatch.setenv(
        "PYTHONPATH",
        os.pathsep.join(
            filter(None, [str(ROOT / "generated" / "python"), str(ROOT), before])
        ),
    )


@pytest.mark.parametrize("loss", ["0", "10", "30"])
def test_every_message_and_files_in_both_directions(loss):
    assert harness.run(CLIENT, SIZE, loss, [], limit=60) is None


@pytest.mark.parametrize("fault", ["corrupt", "late"])
def test_acknowledges_that_are_damaged_or_late_cost_nothing_but_time(fault):
    assert (
        harness.run(CLIENT, 20_481, "10", [f"{fault}=10%@acknowledge"], limit=60)
        is None
    )


def test_another_node_is_noticed():
    assert (
        harness.run(CLIENT, 100, "0", [], node="bootloader", limit=60)
        == "ended with 3: "
    )


def test_a_client_that_leaves_out_telecommands_is_found():
    forgetful = """
import sys
from tests.python import sim_client
sim_client.every_telecommand = lambda device: device.send(sim_client.cubeacp.Reset())
sys.exit(sim_client.main(*sys.argv[1:]))
"""
    found = harness.run([sys.executable, "-c", forgetful], 10, "0", [])
    assert (
        found.startswith("never sent: ")
        and "Reset," not in found
        and "Save Image" in found
        and "Hole Map" not in found
    )

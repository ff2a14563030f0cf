"""Programs that use the generated client communicate with a simulated node.

They exchange every message and transfer files in both directions, also with losses and
faults on the line.

``python -m tests.sim.harness -- CLIENT`` runs a client with a megabyte; ``python -m
tests.c.sim_client FOLDER`` and ``python -m tests.rust.sim_client FOLDER`` build one.
The client in Python is ``PYTHONPATH=generated/python python -m
tests.python.sim_client``.
"""

from __future__ import annotations

import os
import sys

import pytest

from tests.c import sim_client as c
from tests.conftest import ROOT
from tests.rust import sim_client as rust
from tests.sim import harness

SIZE = 65_537  # the last block is shorter, and its last packet has one byte

# Each language has its own error messages.
UNANSWERED = {
    "c": "Identification: not answered",
    "python": "Identification (id 128) had no reply",
    "rust": "no answer to request 128, asked 10 times",
}
REFUSED = {
    "c": "Cache enabled state: refused",
    "python": "was refused: Incorrect Parameter",
    "rust": "request 3 is refused, code 3",
}
NO_FILE = {
    "c": "download: failed",
    "python": "the procedure ended with: failed",
    "rust": "download: the procedure failed: Failed",
}


LANGUAGES = [
    pytest.param("c", marks=pytest.mark.needs("gcc")),
    "python",
    pytest.param("rust", marks=pytest.mark.needs("rustc")),
]


@pytest.fixture(scope="module", params=LANGUAGES)
def language(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def client(language, tmp_path_factory) -> list[str]:
    """Command that starts the client of a language."""
    if language == "c":
        return [str(c.build(tmp_path_factory.mktemp("client")))]
    if language == "rust":
        return rust.build(tmp_path_factory.mktemp("client"))
    return [sys.executable, "-m", "tests.python.sim_client"]


@pytest.fixture(autouse=True)
def python_path(monkeypatch):
    """Set the path with which the client in Python imports the committed package."""
    path = [str(ROOT / "generated" / "python"), str(ROOT)]
    path += filter(None, [os.environ.get("PYTHONPATH")])
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path))


@pytest.mark.parametrize("loss", ["0", "10"])
def test_every_message_and_files_in_both_directions_are_transferred(client, loss):
    assert harness.run(client, SIZE, loss, [], limit=60) is None


@pytest.mark.parametrize("fault", ["corrupt", "late"])
def test_damaged_and_late_acknowledges_only_delay_transfers(client, fault):
    faults = [f"{fault}=10%@acknowledge"]
    assert harness.run(client, 20_481, "10", faults, limit=60) is None


def test_a_client_detects_another_node(client):
    assert harness.against(client, "--node", "bootloader").returncode == 3


@pytest.mark.parametrize(
    ("fault", "reasons"),
    [
        (["--fault", "drop=100%@reply"], UNANSWERED),
        (["--fault", "nack=100%"], REFUSED),
        ([], NO_FILE),  # the simulator has no such file
    ],
)
def test_a_client_reports_missing_responses_refusals_and_missing_files(
    client, language, fault, reasons
):
    done = harness.against(client, "--node", "cubeacp", *fault)
    assert done.returncode == 1 and reasons[language] in done.stderr, done.stderr


def test_the_harness_reports_a_client_that_omits_telecommands():
    forgetful = """
import sys
from tests.python import sim_client
sim_client.every_telecommand = lambda device: device.send(sim_client.cubeacp.Reset())
sys.exit(sim_client.main(*sys.argv[1:]))
"""
    error = harness.run([sys.executable, "-c", forgetful], 10, "0", [])
    assert error.startswith("never sent: ") and "Save Image" in error
    assert "Reset," not in error and "Hole Map" not in error

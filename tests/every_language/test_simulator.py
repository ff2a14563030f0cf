"""A program over the generated client, against the simulator: every message, files in
both directions, losses and faults.

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

SIZE = 65_537  # the last block is of another length, its last packet of one byte

# Each language words its errors itself.
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
    """The command that starts the client."""
    if language == "c":
        return [str(c.build(tmp_path_factory.mktemp("client")))]
    if language == "rust":
        return rust.build(tmp_path_factory.mktemp("client"))
    return [sys.executable, "-m", "tests.python.sim_client"]


@pytest.fixture(autouse=True)
def python_path(monkeypatch):
    """The client in Python imports the committed package."""
    path = [str(ROOT / "generated" / "python"), str(ROOT)]
    path += filter(None, [os.environ.get("PYTHONPATH")])
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path))


@pytest.mark.parametrize("loss", ["0", "10"])
def test_every_message_and_files_in_both_directions(client, loss):
    assert harness.run(client, SIZE, loss, [], limit=60) is None


@pytest.mark.parametrize("fault", ["corrupt", "late"])
def test_acknowledges_that_are_damaged_or_late_cost_nothing_but_time(client, fault):
    faults = [f"{fault}=10%@acknowledge"]
    assert harness.run(client, 20_481, "10", faults, limit=60) is None


def test_another_node_is_noticed(client):
    assert harness.against(client, "--node", "bootloader").returncode == 3


@pytest.mark.parametrize(
    ("fault", "reasons"),
    [
        (["--fault", "drop=100%@reply"], UNANSWERED),
        (["--fault", "nack=100%"], REFUSED),
        ([], NO_FILE),  # the simulator has no such file
    ],
)
def test_a_node_that_does_not_do_what_is_asked_is_noticed(
    client, language, fault, reasons
):
    done = harness.against(client, "--node", "cubeacp", *fault)
    assert done.returncode == 1 and reasons[language] in done.stderr, done.stderr


def test_a_client_that_leaves_out_telecommands_is_found():
    forgetful = """
import sys
from tests.python import sim_client
sim_client.every_telecommand = lambda device: device.send(sim_client.cubeacp.Reset())
sys.exit(sim_client.main(*sys.argv[1:]))
"""
    error = harness.run([sys.executable, "-c", forgetful], 10, "0", [])
    assert error.startswith("never sent: ") and "Save Image" in error
    assert "Reset," not in error and "Hole Map" not in error

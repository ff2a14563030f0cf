"""A program over the generated client, against the simulator: every message, files in
both directions, losses and faults.

``python -m tests.sim.harness -- CLIENT`` runs it with a megabyte; ``python -m
tests.c.sim_client FOLDER`` builds it.
"""

from __future__ import annotations

import pytest

from tests.c import sim_client
from tests.sim import harness

SIZE = 65_537  # the last block is of another length, its last packet of one byte


@pytest.fixture(scope="module")
def client(tmp_path_factory) -> list[str]:
    return [str(sim_client.build(tmp_path_factory.mktemp("client")))]


@pytest.mark.parametrize("loss", ["0", "10"])
def test_every_message_and_files_in_both_directions(client, loss):
    assert harness.run(client, SIZE, loss, [], limit=60) is None


@pytest.mark.parametrize("fault", ["corrupt", "late"])
def test_acknowledges_that_are_damaged_or_late_cost_nothing_but_time(client, fault):
    assert (
        harness.run(client, 20_481, "10", [f"{fault}=10%@acknowledge"], limit=60)
        is None
    )


@pytest.mark.parametrize(
    ("options", "code", "why"),
    [
        (["--node", "bootloader"], 3, ""),
        (
            ["--node", "cubeacp", "--fault", "drop=100%@reply"],
            1,
            "Identification: not answered",
        ),
        (
            ["--node", "cubeacp", "--fault", "nack=100%"],
            1,
            "Cache enabled state: refused",
        ),
        (["--node", "cubeacp"], 1, "download: failed"),  # it has no such file
    ],
)
def test_a_node_that_is_another_one_or_does_not_answer_is_noticed(
    client, options, code, why
):
    done = harness.against(client, *options)
    assert done.returncode == code and why in done.stderr, done.stderr

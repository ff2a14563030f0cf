"""A program over the generated client, against the simulator: every message, files in
both directions, losses and faults.

`python -m tests.sim.harness -- CLIENT` runs it with larger files; `python -m
tests.rust.sim_client FOLDER` builds it.
"""

from __future__ import annotations

import pytest

from tests.rust import sim_client
from tests.sim import harness

SIZE = 65_537  # a last block of one byte


@pytest.fixture(scope="module")
def client(tmp_path_factory) -> list[str]:
    return sim_client.build(tmp_path_factory.mktemp("client"))


@pytest.mark.parametrize("loss", ["0", "10"])
def test_every_message_and_files_in_both_directions(client, loss):
    assert harness.run(client, SIZE, loss, [], limit=60) is None


@pytest.mark.parametrize("fault", ["corrupt", "late"])
def test_acknowledges_that_are_spoilt_or_late_cost_nothing_but_time(client, fault):
    assert (
        harness.run(client, SIZE, "10", [f"{fault}=10%@acknowledge"], limit=60) is None
    )


@pytest.mark.parametrize(
    ("options", "code", "why"),
    [
        (["--node", "bootloader"], 3, ""),
        (
            ["--node", "cubeacp", "--fault", "drop=100%@reply"],
            1,
            "no answer to request 128, asked 10 times",
        ),
        (
            ["--node", "cubeacp", "--fault", "nack=100%"],
            1,
            "request 3 is refused, code 3",
        ),
        (
            ["--node", "cubeacp"],
            1,
            "download: the procedure failed: Failed",
        ),  # it has no such file
    ],
)
def test_a_node_that_is_another_one_or_does_not_answer_is_noticed(
    client, options, code, why
):
    done = harness.against(client, *options)
    assert done.returncode == code and why in done.stderr, done.stderr

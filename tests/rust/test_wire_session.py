"""Sessions of the crate over ports that fail, requests that are given up, and messages of other nodes."""

from __future__ import annotations

from pathlib import Path

from tests.rust.tools import STD, Toolchain, run

PROGRAM = Path(__file__).with_name("session.rs")


def test_sessions_outlive_their_port_and_clients_take_no_message_of_another_node(shipped, tmp_path):
    tools = Toolchain("default")
    library = tools.library(shipped.crate, tmp_path, "0", *STD)
    run(tools.program(PROGRAM, library, tmp_path / "program"))

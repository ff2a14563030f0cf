"""Commands that talk to a device: confirmation of dangerous telecommands, default node,
and reconnection.
"""

from __future__ import annotations

import io
import json
import subprocess
import sys
import time

import pytest

from tests.sim.device import simulator


class Keyboard(io.StringIO):
    """A terminal with scripted input."""

    def isatty(self) -> bool:
        return True


@pytest.fixture(scope="module")
def place():
    with simulator("--node", "cubeacp", "--tcp", "0") as (place, _):
        yield place


FORMAT = ("send", "cubeacp", "Format SD card")


def test_a_dangerous_telecommand_is_shown_with_its_magic_number_and_sent_after_yes(
    icdgen, place, monkeypatch
):
    monkeypatch.setattr(sys, "stdin", Keyboard("y\n"))
    result = icdgen(*FORMAT, "--port", place)
    assert (
        result.status == 0
        and "Format SD card with Magic Number 90 (0x5A): acknowledged" in result.out
    )
    assert (
        "is dangerous: All files on the SD card are lost." in result.err
        and "Send it? [y/N]" in result.err
    )
    assert "\n5a\n" in result.err


@pytest.mark.parametrize("answer", ["n\n", "\n"])
def test_without_confirmation_nothing_is_sent(icdgen, monkeypatch, answer):
    monkeypatch.setattr(sys, "stdin", Keyboard(answer))
    result = icdgen(*FORMAT, "--port", "tcp://127.0.0.1:1")  # the port is not opened
    assert (
        result.status == 1
        and "Format SD card: not sent" in result.err
        and "cannot connect" not in result.err
    )


def test_a_script_must_pass_the_option_yes(icdgen, place, monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.StringIO("y\n"))
    refused = icdgen(*FORMAT, "--port", "tcp://127.0.0.1:1")
    assert (
        refused.status == 2 and "is dangerous" in refused.err and "--yes" in refused.err
    )
    assert icdgen(*FORMAT, "--yes", "--port", place).status == 0


def test_a_wrong_magic_number_is_no_promise_of_a_restart(icdgen, place):
    result = icdgen(
        "send", "cubeacp", "Reset", "magic=1", "--raw", "--yes", "--port", place
    )
    assert (
        "with Magic number 1" in result.out
        and "need not restart" in result.out
        and "90 (0x5A)" in result.out
    )
    assert (
        "the device restarts"
        in icdgen("send", "cubeacp", "Reset", "--yes", "--port", place).out
    )


def test_the_only_node_needs_no_name(icdgen):
    icdgen("init", "battery")
    with simulator("--icd", "icd", "--tcp", "0") as (place, _):
        sent = icdgen("send", "Set Mode", "mode=Test", "--port", place)
        assert (sent.status, sent.out) == (0, "Set Mode: acknowledged\n")
        assert (
            "Temperature" in icdgen("monitor", "Status", "--port", place, "--once").out
        )
        assert "Device type" in icdgen("monitor", "--port", place, "--once").out
        assert (
            "Temperature"
            in icdgen("monitor", "battery", "Status", "--port", place, "--once").out
        )
    assert "\n02\n" in icdgen("encode", "Set Mode", "mode=Test").out


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (("send", "cubeapc", "Reset"), "did you mean `cubeacp`"),
        (("send", "cubeacp"), "no message of cubeacp is named"),
        (("monitor",), "it is not said which node is meant"),
        (("encode", "cubeacp"), "`icdgen show cubeacp` lists what there is"),
    ],
)
def test_missing_or_misspelt_values_are_prompted_for(icdgen, words, answer):
    port = () if words[0] == "encode" else ("--port", "tcp://127.0.0.1:1")
    result = icdgen(*words, *port)
    assert result.status == 2 and answer in result.err


@pytest.mark.parametrize("seconds", ["nan", "inf", "-1", "1e300"])
def test_an_invalid_time_is_refused(icdgen, seconds):
    result = icdgen(
        "monitor", "cubeacp", "--port", "tcp://127.0.0.1:1", f"--every={seconds}"
    )
    assert result.status == 2 and "--every" in result.err


def test_the_monitor_reconnects_after_a_lost_line():
    with simulator("--node", "cubeacp", "--tcp", "0") as (place, first):
        watching = subprocess.Popen(
            [
                sys.executable,
                "-m",
                "icdgen",
                "monitor",
                "cubeacp",
                "146",
                "-p",
                place,
                "--every",
                "0.1",
                "--format",
                "json",
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            assert "Estimated Roll Angle" in watching.stdout.readline()
            first.kill()
            first.wait()
            assert (
                "closed" in (lost := watching.stderr.readline())
                and "trying again" in lost
            )
            time.sleep(0.5)  # some attempts that fail
            port = place.rpartition(":")[2]
            with simulator(
                "--node", "cubeacp", "--tcp", port, "--set", "146", "roll=12.5"
            ):
                assert watching.stderr.readline() == "icdgen: the line is back\n"
                while "12.5" not in (line := watching.stdout.readline()):
                    assert line, "it ended"
        finally:
            watching.kill()
            watching.communicate()


def test_a_lost_line_ends_a_counted_monitor_with_no_answer_and_the_last_values():
    with simulator("--node", "cubeacp", "--tcp", "0") as (place, first):
        command = [
            "monitor",
            "cubeacp",
            "146",
            "-p",
            place,
            "--every",
            "0.2",
            "--count",
            "4",
        ]
        watching = subprocess.Popen(
            [sys.executable, "-m", "icdgen", *command],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert "message" in watching.stdout.readline()
        first.kill()
        out, err = watching.communicate(timeout=30)
    assert (
        watching.returncode == 1
        and "no answer; last value, " in out.splitlines()[-3]
        and err.count("trying again") == 1
    )


def test_several_values_are_set_at_once_as_encode_takes_them(icdgen):
    words = (
        "--set",
        "146",
        "roll=1.5",
        "pitch=-2.25",
        "--set",
        "Satellite Position (LLH)",
        "latitude=48.1",
        "longitude=11.6",
    )
    with simulator("--tcp", "0", *words, "--node", "cubeacp") as (place, _):
        shown = icdgen(
            "monitor",
            "cubeacp",
            "146",
            "150",
            "-p",
            place,
            "--once",
            "--format",
            "json",
        ).out
    angles, position = (
        [field["value"] for field in json.loads(line)["fields"]]
        for line in shown.splitlines()
    )
    assert (angles, position) == ([1.5, -2.25, 0.0], [48.1, 11.6, 0.0])

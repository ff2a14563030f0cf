"""`icdgen sim` gives its options to the simulator unchanged."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path

import pytest

from icdgen.commands.sim import _place
from icdgen.errors import UserError
from icdgen.sim import run

DEFAULTS = {
    "values": (),
    "script": None,
    "files": (),
    "uploads": None,
    "faults": (),
    "late": 1500,
    "seed": 0,
    "boot": None,
    "busy": 20,
    "processing": 0,
    "strict": False,
    "orders": False,
    "every": None,
    "chosen": (),
}


@pytest.fixture
def started(icdgen, demo, monkeypatch):
    """Return a function that runs the command and returns node, ports and options."""
    calls: list[tuple] = []

    def start(icd, name, transports, options, report, warn) -> None:
        assert [node.name for node in icd.nodes] == ["demo"]
        calls.append((name, transports, asdict(options)))

    monkeypatch.setattr(run, "run", start)

    def run_command(*words: object) -> tuple:
        result = icdgen("sim", "--icd", demo, *words)
        assert (result.status, result.err) == (0, "")
        return calls.pop()

    return run_command


def test_the_defaults_are_those_of_the_simulator(started):
    name, transports, options = started()
    assert name is None
    assert transports == (
        [("tcp", "127.0.0.1", 0)] if sys.platform == "win32" else [("pty",)]
    )
    assert options == DEFAULTS == asdict(run.Options())


@pytest.mark.parametrize(
    ("words", "changed"),
    [
        (("--script", "s.yaml"), {"script": Path("s.yaml")}),
        (("--file", "2:1=a", "--file", "2:2=b"), {"files": ("2:1=a", "2:2=b")}),
        (("--uploads", "u"), {"uploads": Path("u")}),
        (("--fault", "drop=1", "--fault", "late=1"), {"faults": ("drop=1", "late=1")}),
        (("--loss", "5%"), {"faults": ("drop=5%@packet,upload",)}),
        (
            ("--fault", "nak=1", "--loss", "0"),
            {"faults": ("nak=1", "drop=0@packet,upload")},
        ),
        (("--late", "7"), {"late": 7}),
        (("--seed", "-3"), {"seed": -3}),
        (("--boot", "0"), {"boot": 0}),
        (("--busy", "0"), {"busy": 0}),
        (("--processing", "8"), {"processing": 8}),
        (("--strict",), {"strict": True}),
        (("--orders",), {"orders": True}),
        (("--every", "0.25"), {"every": 0.25}),
        (("--header", "source=3"), {"chosen": ("source=3",)}),
        (("--set", "A", "x=1"), {"values": (("A", "x=1"),)}),
        (
            ("--set", "A", "x=1", "y=2", "z=3", "--set", "B", "x=4", "y=5"),
            {
                "values": (
                    ("A", "x=1"),
                    ("A", "y=2"),
                    ("A", "z=3"),
                    ("B", "x=4"),
                    ("B", "y=5"),
                )
            },
        ),
        (
            ("--set", "A", "x=1", "--strict", "--set", "B", "x=-1"),
            {"values": (("A", "x=1"), ("B", "x=-1")), "strict": True},
        ),
    ],
)
def test_each_option_changes_one_setting(started, words, changed):
    _, _, options = started(*words)
    assert options == DEFAULTS | changed


def test_values_can_come_first(icdgen, demo, monkeypatch):
    values: list[object] = []
    monkeypatch.setattr(run, "run", lambda *words: values.append(words[3].values))
    icdgen("sim", "--set", "A", "x=1", "y=2", "--icd", demo)
    assert values == [(("A", "x=1"), ("A", "y=2"))]


def test_a_word_after_an_option_without_a_message_is_refused(icdgen, demo):
    result = icdgen("sim", "--icd", demo, "--set", "A", "x=1", "--strict", "y=2")
    assert result.status == 2
    assert "y=2" in result.err


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--tcp", "0"), [("tcp", "127.0.0.1", 0)]),
        (("--udp", "0"), [("udp", "127.0.0.1", 0)]),
        (("--tcp", "65535", "--host", "::1"), [("tcp", "::1", 65535)]),
        (("--connect", "tcp://far:9"), [("connect", "tcp", "far", 9)]),
        (
            ("--udp", "2", "--connect", "udp://far:9", "--tcp", "1", "--pty"),
            [
                ("pty",),
                ("tcp", "127.0.0.1", 1),
                ("udp", "127.0.0.1", 2),
                ("connect", "udp", "far", 9),
            ],
        ),
    ],
)
def test_the_device_is_served_on_the_given_ports_in_a_fixed_order(
    started, monkeypatch, words, expected
):
    assert started("--node", "demo", *words)[:2] == ("demo", expected)


@pytest.mark.parametrize(
    "words",
    [
        ("--tcp", "65536"),
        ("--tcp", "-1"),
        ("--udp", "65536"),
        ("--late", "0"),
        ("--boot", "-1"),
        ("--busy", "-1"),
        ("--processing", "-1"),
        ("--every", "-0.1"),
        ("--every", "nan"),
        ("--every", "86401"),
    ],
)
def test_values_out_of_range_are_misuse(icdgen, demo, words):
    result = icdgen("sim", "--icd", demo, *words)
    assert result.status == 2
    assert words[1] in result.err


def test_there_are_no_pseudo_terminals_on_windows(icdgen, demo, monkeypatch):
    monkeypatch.setattr("icdgen.commands.sim.sys.platform", "win32")
    result = icdgen("sim", "--icd", demo, "--pty")
    assert result.status == 2
    assert "there are no pseudo-terminals here" in result.err
    assert "use --tcp PORT" in result.err


def test_only_tcp_and_udp_can_be_connected_to():
    for text in ("serial:/dev/x", "can://a/b", "host:4000", "TCP://a:1"):
        with pytest.raises(UserError) as error:
            _place(text)
        assert str(error.value) == f"`{text}` is nothing to connect to"
        assert error.value.help == "--connect tcp://HOST:PORT or udp://HOST:PORT"
    assert _place("udp://a:1") == ("udp", "a", 1)

"""From an empty folder to a device that answers."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from icdgen.recognize import recognize


def test_the_first_icd_is_clean_formatted_and_generates_every_language(icdgen, tmp_path):
    result = icdgen("init", "battery")
    assert result.status == 0 and "icd/battery.yaml written" in result.out
    checked = icdgen("check")
    assert checked.status == 0 and "no findings" in checked.out, checked.out
    assert icdgen("fmt", "--check").status == 0
    assert icdgen(*"--lang c --lang python --lang rust --lang vectors --lang html".split()).status == 0
    assert (tmp_path / "generated" / "c" / "battery.h").is_file()


@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals")
def test_the_first_device_answers_in_the_simulator(icdgen, tmp_path):
    icdgen("init", "battery")
    simulator = subprocess.Popen(
        [sys.executable, "-m", "icdgen", "sim"], cwd=tmp_path, stdout=subprocess.PIPE, text=True, env=os.environ
    )
    try:
        path = simulator.stdout.readline().split()[-1]
        port = path.removeprefix("pty:")
        result = icdgen("monitor", "battery", "Status", "--port", port, "--once")
        assert result.status == 0 and "Temperature" in result.out, result
    finally:
        simulator.terminate()
        simulator.wait()
        simulator.stdout.close()


def test_its_frames_are_recognized(icdgen, tmp_path):
    icdgen("init", "battery")
    from icdgen.loading import load

    (one,) = recognize(load([tmp_path / "icd"]).icd, "10 02 81 01 03 10 10 27 88 13 10 03")
    assert [row.text for row in one.frame.rows] == ["Normal", "true", "true", "100", "5000"]


def test_nothing_that_is_there_is_touched(icdgen, tmp_path):
    (tmp_path / "icdgen.toml").write_text("# mine\n")
    icdgen("init", "battery")
    (tmp_path / "icd" / "battery.yaml").write_text("mine\n")
    result = icdgen("init", "battery")
    assert result.status == 2 and "is there already" in result.err
    assert (tmp_path / "icd" / "battery.yaml").read_text() == "mine\n"
    assert (tmp_path / "icdgen.toml").read_text() == "# mine\n"


@pytest.mark.parametrize(
    ("name", "proposal"), [("My Battery", "my_battery"), ("3cell", "cell"), ("../x", "x"), ("", "battery")]
)
def test_a_name_that_no_node_can_have_is_answered_with_one_that_can(icdgen, tmp_path, name, proposal):
    result = icdgen("init", name)
    assert result.status == 2 and f"icdgen init {proposal}`" in result.err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("word", "answer"),
    [("chekc", "did you mean `check`?"), ("Check", "did you mean `check`?"), ("quux", "`icdgen --help` lists them")],
)
def test_a_mistyped_command_is_answered_with_the_one_meant(icdgen, word, answer):
    result = icdgen(word)
    assert result.status == 2 and f"there is no command `{word}`" in result.err and answer in result.err


def test_a_folder_named_like_a_slip_is_still_an_icd(icdgen, tmp_path):
    (tmp_path / "chek").mkdir()
    assert "there is no command" not in icdgen("chek", "--lang", "c").err


def test_units_are_listed_with_the_spellings_they_replace(icdgen):
    lines = icdgen("units").out.splitlines()
    assert any(line.split()[0] == "C" and "degC" in line for line in lines)

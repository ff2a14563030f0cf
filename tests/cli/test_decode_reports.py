"""`icdgen decode` reports everything that it cannot decode, in its output and exit
status.
"""

from __future__ import annotations

import csv
import json

import pytest

from tests.conftest import ROOT
from tests.recognize.test_cut_frames import MOTOR, POWER, SPEED
from tests.recognize.test_identifiers import CANDUMP, TRAIN

LINKS = ROOT / "examples" / "links"


@pytest.fixture
def motor(tmp_path):
    file = tmp_path / "motor.yaml"
    file.write_text(MOTOR)
    return file


@pytest.fixture
def train(tmp_path):
    file = tmp_path / "train.yaml"
    file.write_text(TRAIN)
    return file


def test_a_command_cut_short_is_an_error(icdgen, motor):
    result = icdgen("decode", "--icd", motor, "A5 5A 03 02 01 86")
    assert result.status == 2 and result.out == ""
    assert (
        "`Set Speed` (telecommand 3) is cut off: 6 bytes came, 7 are needed"
        in result.err
    )


@pytest.mark.parametrize("form", ["text", "json", "csv"])
def test_packets_that_cannot_be_decoded_are_reported_in_every_format_with_exit_status_1(
    icdgen, motor, form
):
    unknown, damaged = "a55a090009", POWER[:-2] + "ff"
    result = icdgen(
        "decode", "--icd", motor, "--format", form, SPEED + unknown + damaged
    )
    assert result.status == 1
    shown = result.err if form == "csv" else result.out
    assert "with the id 9 and 0 bytes of data is no message" in shown
    assert "has a wrong checksum: it is FF, expected 0E" in shown
    assert icdgen("decode", "--icd", motor, "--format", form, SPEED).status == 0


def test_csv_reports_identifiers_that_no_message_has_and_wrong_lengths(icdgen, train):
    result = icdgen(
        "decode", "--icd", train, "--format", "csv", CANDUMP + "\n(1.0) can0 100#01"
    )
    assert result.status == 1
    assert (
        "no message of train has the CAN identifier 0x7FF (1 CAN packet)" in result.err
    )
    assert "`Drive` (telemetry 256) has 8 bytes, 1 given" in result.err


def test_times_of_candump_are_in_every_format(icdgen, train):
    log = "\n".join(line for line in CANDUMP.splitlines() if "7FF" not in line)
    assert (
        "time 1600000000.250000\ntrain: Drive"
        in icdgen("decode", "--icd", train, log).out
    )
    frames = json.loads(icdgen("decode", "--icd", train, "--format", "json", log).out)
    assert [frame["time"] for frame in frames] == [
        "1600000000.250000",
        "1600000002.000000",
    ]
    rows = csv.DictReader(
        icdgen("decode", "--icd", train, "--format", "csv", log).out.splitlines()
    )
    assert [row["time"] for row in rows] == ["1600000000.250000", "1600000002.000000"]


def test_ids_of_two_bytes_are_written_as_the_protocol_writes_them(icdgen):
    frame = "B5 62 01 61 04 00 01 00 00 00 67 A0"
    result = icdgen("decode", "--icd", LINKS / "ubx.yaml", frame)
    assert (
        "`End of Epoch` (telemetry 01 61) has a wrong checksum: it is 67 A0, expected 67 CB"
        in result.err
    )
    result = icdgen("decode", "--icd", LINKS / "ubx.yaml", frame.replace("A0", "CB"))
    assert "receiver: End of Epoch (telemetry 01 61), 4 bytes" in result.out
    assert "header with id 01 61 removed" in result.out
    named = icdgen(
        "decode", "--icd", LINKS / "ubx.yaml", "receiver", "01 61", "01 00 00 00"
    )
    assert "receiver: End of Epoch (telemetry 01 61), 4 bytes" in named.out

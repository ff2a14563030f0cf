"""Listings of logs and recordings: the complete text."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.loading import load
from icdgen.logfile import listing
from icdgen.logfile.log import open_log
from icdgen.logfile.recording import Recording
from icdgen.logfile.source import open_source
from tests.log.test_recordings import CLOCK_DATA, EPOCH, OTHER, PACKETS, UBX, ubx


def ignore(size: int) -> None:
    """Do nothing with the number of processed bytes."""


def recording(path: Path, *data: bytes, file: Path = UBX, **options) -> Recording:
    path.write_bytes(b"".join(data))
    icd = load([file]).icd
    return Recording(icd, icd.nodes[0], path, **options)


def text_of(of: Recording) -> str:
    return listing.recording_text(of, of.survey(None, ignore), None)


RECORDING = """\
{path}: telemetry of receiver, 1060 bytes, 26 messages

 id  message           times  bytes  fields
---  ----------------  -----  -----  ------
290  Navigation Clock     25    500       5
353  End of Epoch          1      4       1

note: ids that the ICD does not have: 263 (1)

note: bytes that belong to no message: 11

note: bytes at the end that belong to no whole message: 3
"""


def test_a_recording_is_listed_with_the_numbers_of_its_messages(tmp_path):
    data = ubx(*[CLOCK_DATA] * 25, EPOCH, OTHER)
    path = tmp_path / "capture"
    text = text_of(recording(path, data, ubx(EPOCH)[:3]))
    size = len(data) + 3
    assert text == RECORDING.format(path=path).replace("1060 bytes", f"{size} bytes")


def test_telecommands_are_listed_with_their_own_ids(tmp_path):
    icd = tmp_path / "odd.yaml"
    icd.write_text(PACKETS)
    sent = bytes.fromhex("0501010709000402020800")
    of = recording(tmp_path / "sent", sent, file=icd, direction="telecommand")
    assert text_of(of) == (
        f"{tmp_path / 'sent'}: telecommand of odd, 11 bytes, 2 messages\n\n"
        "id  message  times  bytes  fields\n"
        "--  -------  -----  -----  ------\n"
        " 1  Set          1      1       1\n"
        " 2  Ask          1      1       1\n"
    )


def test_an_empty_recording_has_no_table(tmp_path):
    path = tmp_path / "empty"
    assert text_of(recording(path)) == (
        f"{path}: telemetry of receiver, 0 bytes, 0 messages\n"
    )


def test_large_numbers_have_separators(tmp_path):
    data = ubx(EPOCH) * 1000
    text = text_of(recording(tmp_path / "long", data))
    assert text.splitlines()[0].endswith(" bytes, 1,000 messages")
    assert text.splitlines()[-1].split() == [
        "353",
        "End",
        "of",
        "Epoch",
        "1,000",
        "4,000",
        "1",
    ]


@pytest.mark.parametrize("count", [0, 1, 2, 1000])
def test_a_log_is_listed_with_a_row_for_each_bit_of_its_mask(
    icd, node_facts, everything, write, count
):
    path, _ = write(everything, count, b"")
    source = open_source(icd, node_facts.node, path)
    lines = listing.to_text(source, None).splitlines()
    size = path.stat().st_size
    entry_bytes = source.plan.entry_bytes
    entries = {1: "1 entry"}.get(count, f"{count:,} entries")
    start, end = "2020-09-13T12:26:40.000Z", "2020-09-13T12:26:41.007Z"
    times = {0: "", 1: f", {start}", 2: f", {start} to {end}"}
    assert lines[0] == f"{path}: log of cubeacp, {size:,} bytes"
    second = f"{entries} of {entry_bytes} bytes"
    assert lines[1] == second + times.get(count, lines[1][len(second) :])
    assert lines[2:4] == [f"mask {everything.hex(' ')}", ""]
    assert lines[4].split() == ["bit", "id", "frame", "bytes", "fields"]
    rows = []
    for slot in source.plan.slots:
        message = node_facts.telemetry.get(slot.id) if slot.id is not None else None
        fields = sum(
            field.role != "count" and field.at + field.bits <= slot.length * 8
            for field in (icd.longest_frame(message) if message else ())
        )
        id = [] if slot.id is None else [str(slot.id)]
        name = (slot.name or "(not assigned)").split()
        rows.append([str(slot.bit), *id, *name, str(slot.length), str(fields)])
    assert [line.split() for line in lines[6 : 6 + len(rows)]] == rows
    assert all(
        line == "" or line.startswith("note: ") for line in lines[6 + len(rows) :]
    )
    assert any("(not" in row for row in rows)


def test_a_log_without_frames_says_so(icd, node_facts, write):
    path, _ = write(bytes(node_facts.mask.size), 2, b"abc")
    source = open_source(icd, node_facts.node, path)
    assert listing.to_text(source, None).endswith(
        "\n\nThe mask selects no frame.\n"
        "\nnote: the mask selects no frame; is this a log of cubeacp?\n"
        "\nnote: the last 3 bytes belong to no whole entry\n"
    )


def test_the_listing_of_a_log_is_that_of_the_command(tmp_path):
    path = tmp_path / "capture"
    path.write_bytes(ubx(EPOCH))
    icd = load([UBX]).icd
    log = open_log(icd, icd.nodes[0], path, "telemetry", [])
    sizes: list[int] = []
    text = log.listing(None, sizes.append)
    assert text == text_of(recording(path, ubx(EPOCH)))
    assert sum(sizes) == len(ubx(EPOCH))

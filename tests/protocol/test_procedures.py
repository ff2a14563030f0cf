"""Files arrive byte for byte, whatever is lost on the way, and what cannot succeed ends
and says why.
"""

from __future__ import annotations

from random import Random

import pytest

from icdgen.protocol import errors, facts, programs, transfer
from icdgen.vectors.wire import node as nodes
from icdgen.vectors.wire.procedures import record

LOSSES = [0.0, 0.01, 0.1, 0.3]


@pytest.mark.parametrize("loss", LOSSES)
@pytest.mark.parametrize("bus", ["uart", "i2c", "can"])
def test_a_downloaded_file_is_the_file(known, bus, loss):
    node = nodes.FileNode(known, bus, Random(f"{bus} {loss}"), loss)
    node.files[2, 7] = node.source.randbytes(50_001)
    _, download = record(
        known,
        {"do": "download", "bus": bus, "type": 2, "counter": 7, "size": 50_001},
        node,
    )
    assert download.result == "done"
    assert b"".join(data for _, data in download.blocks) == node.files[2, 7]
    assert [offset for offset, _ in download.blocks] == [0, 20480, 40960]


@pytest.mark.parametrize("size", [0, 1, 20, 20480, 20481])
def test_a_file_of_unknown_size_ends_where_it_ends(known, size):
    node = nodes.FileNode(known, "uart", Random(size), 0.1)
    node.files[15, 0] = node.source.randbytes(size)
    _, download = record(
        known, {"do": "download", "bus": "uart", "type": 15, "counter": 0}, node
    )
    assert download.result == "done"
    assert b"".join(data for _, data in download.blocks) == node.files[15, 0]


@pytest.fixture(scope="module")
def boot(icd):
    return facts.of(icd, icd.node("bootloader"))


@pytest.mark.parametrize("loss", LOSSES)
def test_an_uploaded_program_is_the_program(boot, loss):
    node = nodes.FileNode(boot, "uart", Random(str(loss)), loss)
    data = node.source.randbytes(30_007)
    _, upload = record(
        boot, {"do": "upload", "destination": 3, "bytes": data.hex()}, node
    )
    assert (upload.result, upload.sent) == ("done", len(data))
    assert node.program == data


@pytest.mark.parametrize("loss", LOSSES)
def test_no_file_is_missed_in_the_list_and_none_is_there_twice(known, loss):
    node = nodes.FileNode(known, "uart", Random(str(loss)), loss)
    for counter in range(30):
        node.files[2, counter] = bytes(counter)
    _, list_ = record(known, {"do": "list"}, node)
    assert list_.result == "done"
    assert [(e["type"], e["counter"], e["size"]) for e in list_.entries] == [
        (2, n, n) for n in range(30)
    ]


def test_a_node_that_loses_everything_is_given_up(known):
    node = nodes.FileNode(known, "uart", Random(1), 1.0)
    node.files[2, 0] = bytes(100)
    _, download = record(
        known,
        {"do": "download", "bus": "uart", "type": 2, "counter": 0, "size": 100},
        node,
    )
    assert download.result == "timeout"


def test_packets_that_do_not_belong_to_the_block_change_nothing(known):
    node = nodes.FileNode(known, "uart", Random(1))
    node.files[2, 0] = bytes(range(100))
    download = transfer.Download(known, "uart", 2, 0, 100)
    asked, now = download.next(0), 0
    while download.result is None and now < 1000:
        now += 1
        download.event(now, {"event": "packet", "number": 700, "bytes": "ff" * 20})
        for event in node.answer(asked) if asked else ():
            download.event(now, event)
        asked = download.next(now)
    assert b"".join(data for _, data in download.blocks) == bytes(range(100))


def test_an_upload_through_a_node_that_takes_none_does_not_begin(known):
    with pytest.raises(facts.Unsupported, match="upload"):
        transfer.Upload(known, 3, bytes(100))


@pytest.mark.parametrize("destination", [0, 2, 10, 17, 255])
def test_an_upload_to_a_destination_that_is_not_supported_does_not_begin(
    boot, destination
):
    with pytest.raises(errors.RangeError):
        transfer.Upload(boot, destination, bytes(100))


def test_an_upload_of_more_than_a_destination_holds_does_not_begin(boot):
    transfer.Upload(boot, 9, bytes(512 * 1024))
    with pytest.raises(errors.TooLongError) as caught:
        transfer.Upload(boot, 9, bytes(600 * 1024))
    assert (caught.value.expected, caught.value.actual) == (524_288, 614_400)


@pytest.mark.parametrize("program", [0, 1, 2, 10])
def test_only_programs_that_can_be_copied_are_copied(boot, program):
    with pytest.raises(errors.RangeError):
        programs.ProgramCopy(boot, program)


def told(boot, procedure, *frames: str) -> str | None:
    """How it ends when these are the frames of its progress."""
    procedure.next(0)
    for data in ("", *frames):
        procedure.event(0, {"event": "done", "bytes": data})
        procedure.next(boot.program_copy.poll_interval)
    return procedure.result


def test_a_copy_is_done_when_the_node_says_so_and_failed_when_it_says_that(boot):
    assert told(boot, programs.ProgramCopy(boot, 3), "01", "01", "00") == "done"
    assert told(boot, programs.ProgramCopy(boot, 3), "01", "02") == "error"
    assert told(boot, programs.ProgramCopy(boot, 3), "01") is None


def test_information_about_another_program_is_not_taken_for_that_of_the_one_asked_for(
    boot,
):
    information = programs.ProgramInformation(boot, 4)
    assert (
        told(boot, information, "0300100000000100") is None and information.size is None
    )
    procedure = programs.ProgramInformation(boot, 4)
    assert (
        told(
            boot, procedure, "0300100000000100", "0401000000000000", "0400070000003412"
        )
        == "done"
    )
    assert (procedure.size, procedure.checksum) == (7, 0x1234)

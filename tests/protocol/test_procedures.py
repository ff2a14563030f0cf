"""Files arrive byte for byte, whatever is lost on the way, and what cannot succeed ends
and says why.
"""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.errors import TooLongError, UnsupportedError
from icdgen_runtime.wire.events import Done, Packet, Refused, Timeout
from icdgen_runtime.wire.programs import ProgramCopy, ProgramInformation
from icdgen_runtime.wire.transfer import Download, FileList, Format, Upload

from icdgen.protocol import facts
from icdgen.runtime_objects.file_procedures import event_of, procedure_of
from icdgen.vectors.wire.node import FileNode
from icdgen.vectors.wire.procedures import record
from tests import links

LOSSES = [0.0, 0.01, 0.1, 0.3]


@pytest.mark.parametrize("loss", LOSSES)
@pytest.mark.parametrize("bus", ["uart", "i2c", "can"])
def test_a_downloaded_file_is_the_file(link, known, bus, loss):
    node = FileNode(link, known, bus, Random(f"{bus} {loss}"), loss)
    node.files[2, 7] = node.source.randbytes(50_001)
    _, download = record(
        link,
        {"do": "download", "bus": bus, "type": 2, "counter": 7, "size": 50_001},
        node,
    )
    assert download.result == "done"
    assert download.data == node.files[2, 7]
    assert [offset for offset, _ in download.blocks] == [0, 20480, 40960]


@pytest.mark.parametrize("size", [0, 1, 20, 20480, 20481])
def test_a_file_of_unknown_size_ends_where_it_ends(link, known, size):
    node = FileNode(link, known, "uart", Random(size), 0.1)
    node.files[15, 0] = node.source.randbytes(size)
    _, download = record(
        link, {"do": "download", "bus": "uart", "type": 15, "counter": 0}, node
    )
    assert download.result == "done"
    assert download.data == node.files[15, 0]


@pytest.fixture(scope="module")
def boot(icd):
    return links.link(icd, "bootloader")


@pytest.mark.parametrize("loss", LOSSES)
def test_an_uploaded_program_is_the_program(icd, boot, loss):
    known = facts.of(icd, icd.node("bootloader"))
    node = FileNode(boot, known, "uart", Random(str(loss)), loss)
    data = node.source.randbytes(30_007)
    _, upload = record(
        boot, {"do": "upload", "destination": 3, "bytes": data.hex()}, node
    )
    assert (upload.result, upload.sent) == ("done", len(data))
    assert node.program == data


@pytest.mark.parametrize("loss", LOSSES)
def test_no_file_is_missed_in_the_list_and_none_is_there_twice(link, known, loss):
    node = FileNode(link, known, "uart", Random(str(loss)), loss)
    for counter in range(30):
        node.files[2, counter] = bytes(counter)
    _, list_ = record(link, {"do": "list"}, node)
    assert list_.result == "done"
    assert [(e.type, e.counter, e.size) for e in list_.entries] == [
        (2, n, n) for n in range(30)
    ]


def test_a_node_that_loses_everything_is_given_up(link, known):
    node = FileNode(link, known, "uart", Random(1), 1.0)
    node.files[2, 0] = bytes(100)
    _, download = record(
        link,
        {"do": "download", "bus": "uart", "type": 2, "counter": 0, "size": 100},
        node,
    )
    assert download.result == "timeout"


def test_packets_that_do_not_belong_to_the_block_change_nothing(link, known):
    node = FileNode(link, known, "uart", Random(1))
    node.files[2, 0] = bytes(range(100))
    download = Download(link, "uart", 2, 0, 100)
    asked, now = download.next(0), 0
    while download.result is None and now < 1000:
        now += 1
        download.event(now, Packet(700, b"\xff" * 20))
        for event in node.answer(asked) if asked else ():
            download.event(now, event_of(event))
        asked = download.next(now)
    assert download.data == bytes(range(100))


def test_an_upload_through_a_node_that_takes_none_does_not_begin(link):
    with pytest.raises(UnsupportedError, match="upload"):
        Upload(link, 3, bytes(100))


@pytest.mark.parametrize("destination", [0, 2, 10, 17, 255])
def test_an_upload_to_a_destination_that_is_not_supported_does_not_begin(
    boot, destination
):
    with pytest.raises(RangeError):
        Upload(boot, destination, bytes(100))


def test_an_upload_of_more_than_a_destination_holds_does_not_begin(boot):
    Upload(boot, 9, bytes(512 * 1024))
    with pytest.raises(TooLongError) as caught:
        Upload(boot, 9, bytes(600 * 1024))
    assert (caught.value.expected, caught.value.actual) == (524_288, 614_400)


@pytest.mark.parametrize("program", [0, 1, 2, 10])
def test_only_programs_that_can_be_copied_are_copied(boot, program):
    with pytest.raises(RangeError):
        ProgramCopy(boot, program)


def told(boot, procedure, *frames: str) -> str | None:
    """How it ends when these are the frames of its progress."""
    procedure.next(0)
    for data in ("", *frames):
        procedure.event(0, Done(0, 1, bytes.fromhex(data)))
        procedure.next(boot.program_copy.poll_interval)
    return procedure.result


def test_a_copy_is_done_when_the_node_says_so_and_failed_when_it_says_that(boot):
    assert told(boot, ProgramCopy(boot, 3), "01", "01", "00") == "done"
    assert told(boot, ProgramCopy(boot, 3), "01", "02") == "error"
    assert told(boot, ProgramCopy(boot, 3), "01") is None


def test_information_about_another_program_is_not_taken_for_that_of_the_one_asked_for(
    boot,
):
    information = ProgramInformation(boot, 4)
    assert (
        told(boot, information, "0300100000000100") is None and information.size is None
    )
    procedure = ProgramInformation(boot, 4)
    assert (
        told(
            boot, procedure, "0300100000000100", "0401000000000000", "0400070000003412"
        )
        == "done"
    )
    assert (procedure.size, procedure.checksum) == (7, 0x1234)


def test_what_the_icd_does_not_describe_is_unsupported(link):
    with pytest.raises(UnsupportedError):
        FileList(link._replace(files=None))
    with pytest.raises(UnsupportedError, match="format"):
        Format(link._replace(files=link.files._replace(format=None)))


KINDS = [
    {"do": "list"},
    {"do": "download", "bus": "uart", "type": 2, "counter": 1, "size": 130, "block": 80},
    {"do": "download", "bus": "i2c", "type": 2, "counter": 1, "block": 60},
    {"do": "download", "bus": "can", "type": 2, "counter": 2, "size": 0},
    {"do": "upload", "destination": 3, "bytes": bytes(range(150)).hex(), "block": 80},
    {"do": "erase", "type": 2, "counter": 1, "all": True},
    {"do": "format"},
    {"do": "program_copy", "program": 3},
    {"do": "program_information", "program": 3},
]  # fmt: skip
OUTCOMES = st.sampled_from(["done", "done", "done", "refused", "timeout"])
MOST_STEPS = 2000
RESULTS = (
    "done", "refused", "timeout", "parameter", "length", "rounds", "checksum", "error",
)  # fmt: skip


@given(st.data(), st.sampled_from(KINDS))
@settings(max_examples=150)
def test_whatever_happens_it_ends_once_nothing_is_answered(boot, data, request):
    """Each request has an outcome; a frame holds anything, and time goes on by leaps."""
    procedure, now, pending = procedure_of(boot, request), 0, None
    for step in range(MOST_STEPS):
        asked = procedure.next(now)
        assert not (asked and pending), "a request before the outcome of another"
        pending = asked or pending
        if procedure.result:
            break
        is_silent = step >= 40
        if pending is None and is_silent:
            now = procedure.deadline
            continue
        now += 0 if is_silent else data.draw(st.sampled_from([0, 1, 50, 600, 20_000]))
        if pending is None:
            piece = data.draw(st.binary(min_size=20, max_size=20))
            procedure.event(now, Packet(data.draw(st.integers(0, 9)), piece))
        else:
            procedure.event(now, outcome(boot, data, pending, is_silent))
            pending = None
    assert procedure.result in RESULTS
    assert (procedure.next(now), procedure.deadline) == (None, None)
    transferred, total = procedure.progress
    if isinstance(procedure, Download):
        assert transferred == len(procedure.data)
    if procedure.result == "done" and total is not None:
        assert transferred == total


def outcome(link, data, request, is_silent):
    kind = "timeout" if is_silent else data.draw(OUTCOMES)
    if kind == "refused":
        return Refused(request.id, 1)
    if kind == "timeout":
        return Timeout(request.id, 1)
    length = link.frames[request.id] if request.kind == "telemetry" else 0
    numbers = st.sampled_from([0, 0, 1, 2, 130, 255])
    frame = data.draw(st.lists(numbers, min_size=length, max_size=length))
    return Done(request.id, 1, bytes(frame))

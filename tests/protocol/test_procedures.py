"""Files and programs are transferred byte for byte in spite of lost messages, and a
procedure that cannot succeed ends with the reason.

The device is the one that `icdgen.procedures` derives from the steps of the ICD.
"""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.errors import TooLongError, UnsupportedError
from icdgen_runtime.wire.events import Arrived, Done, Refused, Sent, Timeout
from icdgen_runtime.wire.procedures import Procedure

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from icdgen.runtime_objects.procedures import (
    event_of,
    procedure,
    procedure_of,
    row_of,
)
from icdgen.vectors.wire.recording import ClientReport, RecordedDevice, record
from tests import links
from tests.conftest import ROOT

LOSSES = [0.0, 0.01, 0.1, 0.3]
FILE = (2, 7)  # type and counter


@pytest.fixture(scope="module")
def boot(icd):
    return links.link(icd, "bootloader")


@pytest.fixture(scope="module")
def boot_facts(icd):
    return facts.of(icd, icd.node("bootloader"))


@pytest.fixture(scope="module")
def loader():
    """Facts and link of a bootloader on a framed link, which has no roles."""
    icd = load([ROOT / "examples" / "links" / "bootloader.yaml"]).icd
    loader_facts = facts.of(icd, icd.node("loader"))
    return loader_facts, link_of(icd, loader_facts)


def download(size=None, **more) -> dict:
    inputs = {"type": FILE[0], "counter": FILE[1]} | (
        {} if size is None else {"size": size}
    )
    return {"name": "download", "inputs": inputs, **more}


def device_with(node_facts, content: bytes, bus="uart", loss=0.0) -> RecordedDevice:
    device = RecordedDevice(node_facts, bus, Random(f"{bus} {loss}"), loss)
    kind = device.counterpart.runs["download"].effect.kind
    device.device.objects.put(kind, FILE, content)
    return device


@pytest.mark.parametrize("loss", LOSSES)
@pytest.mark.parametrize("bus", ["uart", "i2c", "can"])
def test_a_downloaded_file_is_the_file(link, acp_facts, bus, loss):
    content = Random(loss).randbytes(50_001)
    device = device_with(acp_facts, content, bus, loss)
    _, procedure = record(link, download(len(content), bus=bus), device.respond)
    assert (procedure.result, procedure.data) == ("done", content)
    assert [offset for offset, _ in procedure.blocks] == [0, 20480, 40960]


@pytest.mark.parametrize("size", [0, 1, 20, 20480, 20481])
def test_a_file_of_unknown_size_is_downloaded_to_its_end(link, acp_facts, size):
    content = Random(size).randbytes(size)
    device = device_with(acp_facts, content, loss=0.1)
    _, procedure = record(link, download(), device.respond)
    assert (procedure.result, procedure.data) == ("done", content)


@pytest.mark.parametrize("block", [1, 7, 20, 21, 4000])
def test_a_file_arrives_in_blocks_of_any_size(link, acp_facts, block):
    content = Random(block).randbytes(60 if block < 20 else 5001)
    device = device_with(acp_facts, content, loss=0.1)
    request = download(len(content), block=block)
    _, procedure = record(link, request, device.respond)
    assert (procedure.result, procedure.data) == ("done", content)


@pytest.mark.parametrize("loss", LOSSES)
def test_an_uploaded_program_is_the_program(boot, boot_facts, loss):
    device = RecordedDevice(boot_facts, "uart", Random(str(loss)), loss)
    data = Random(loss).randbytes(30_007)
    request = {"name": "upload", "inputs": {"destination": 3}, "bytes": data.hex()}
    _, procedure = record(boot, request, device.respond)
    assert (procedure.result, procedure.progress) == ("done", (len(data), len(data)))
    assert device.device.objects.content_of("upload", (3,)) == data


@pytest.mark.parametrize("loss", LOSSES)
@pytest.mark.parametrize("size", [0, 1, 128, 1024, 1025, 5000])
def test_a_program_reaches_a_device_with_other_steps(loader, size, loss):
    loader_facts, link = loader
    device = RecordedDevice(loader_facts, "uart", Random(f"{size} {loss}"), loss)
    data = Random(size).randbytes(size)
    for _ in range(2):  # the second one replaces the first one
        data = data[::-1]
        request = {"name": "upload", "inputs": {"area": 1}, "bytes": data.hex()}
        _, procedure = record(link, request, device.respond)
        assert procedure.result == "done"
        assert device.device.objects.content_of("upload", (1,)) == data


@pytest.mark.parametrize("loss", LOSSES)
def test_every_file_is_listed_exactly_once(link, acp_facts, loss):
    device = RecordedDevice(acp_facts, "uart", Random(str(loss)), loss)
    entries = [
        bytes([2, number, *Random(number).randbytes(10)]) for number in range(30)
    ]
    device.counterpart.runs["list"].entries = entries
    _, procedure = record(link, {"name": "list"}, device.respond)
    assert (procedure.result, procedure.frames) == ("done", entries)


def test_a_procedure_ends_if_the_node_loses_everything(link, acp_facts):
    device = device_with(acp_facts, bytes(100), loss=1.0)
    _, procedure = record(link, download(100), device.respond)
    assert procedure.result == "timeout"


def test_a_procedure_ends_if_the_node_loses_every_packet(link, acp_facts):
    device = device_with(acp_facts, bytes(100))
    device.packet_loss = 1.0
    _, procedure = record(link, download(100), device.respond)
    assert procedure.result == "rounds"


def test_packets_that_do_not_belong_to_the_block_change_nothing(link, acp_facts):
    content = bytes(range(100))
    device = device_with(acp_facts, content)
    id = acp_facts.unsolicited[119]
    strange = {
        "event": "arrived",
        "id": id,
        "bytes": (700).to_bytes(2, "little").hex() + "ff" * 20,
    }

    def respond(now, request):
        return [ClientReport(strange), *device.respond(now, request)]

    _, procedure = record(link, download(100), respond)
    assert (procedure.result, procedure.data) == ("done", content)


def test_an_upload_to_a_node_without_uploads_does_not_begin(link):
    with pytest.raises(UnsupportedError, match="upload"):
        Procedure(link, "upload", {"destination": 3}, bytes(100))


@pytest.mark.parametrize("destination", [0, 2, 10, 17, 255])
def test_an_upload_to_a_destination_that_is_not_supported_does_not_begin(
    boot, destination
):
    with pytest.raises(RangeError):
        Procedure(boot, "upload", {"destination": destination}, bytes(100))


def test_an_upload_of_more_than_a_destination_holds_does_not_begin(boot):
    Procedure(boot, "upload", {"destination": 9}, bytes(512 * 1024))
    with pytest.raises(TooLongError) as caught:
        Procedure(boot, "upload", {"destination": 9}, bytes(600 * 1024))
    assert (caught.value.expected, caught.value.actual) == (524_288, 614_400)


@pytest.mark.parametrize("program", [0, 1, 2, 10])
def test_only_programs_that_can_be_copied_are_copied(boot, program):
    with pytest.raises(RangeError):
        Procedure(boot, "program_copy", {"program": program})


def result_of(procedure, *frames: str) -> str | None:
    """Return how a procedure ends if these are the frames of its progress."""
    procedure.next(0)
    for data in ("", *frames):
        procedure.event(0, Done(0, 1, bytes.fromhex(data)))
        procedure.next(50)
    return procedure.result


def test_a_copy_is_done_or_failed_when_the_node_reports_it(boot):
    def copy():
        return Procedure(boot, "program_copy", {"program": 3})

    assert result_of(copy(), "01", "01", "00") == "done"
    assert result_of(copy(), "01", "02") == "failed"
    assert result_of(copy(), "01") is None


def test_information_about_another_program_is_ignored(boot):
    other, own = "0300100000000100", "0400070000003412"
    procedure = Procedure(boot, "program_information", {"program": 4})
    assert result_of(procedure, other) is None
    assert procedure.output("size") is None
    procedure = Procedure(boot, "program_information", {"program": 4})
    assert result_of(procedure, other, "0401000000000000", own) == "done"
    assert (procedure.output("size"), procedure.output("checksum")) == (7, 0x1234)


def test_a_script_shows_the_request_the_deadline_and_the_result_after_each_row(boot):
    def done(data):
        return {"event": "done", "bytes": data}

    script = [
        {"at": 0},
        {"at": 5, "event": done("")},
        {"at": 110, "event": done("01")},  # busy: asks again after 50 ms
        {"at": 159},
        {"at": 160},
        {"at": 200, "event": done("00")},
    ]
    inputs = {"program": 3}
    row = {"name": "program_copy", "inputs": inputs, "script": script}
    steps = procedure(boot, row)["steps"]
    copy = {"telecommand": 103, "bytes": "0300", "repeat": True}
    assert [tuple(step.values()) for step in steps] == [
        (copy, None, None),
        ({"telemetry": 233}, None, None),
        (None, 160, None),
        (None, 160, None),
        ({"telemetry": 233}, None, None),
        (None, None, "done"),
    ]


@pytest.mark.parametrize(
    "row",
    [
        {"event": "done", "bytes": "01ff"},
        {"event": "sent"},
        {"event": "busy"},
        {"event": "refused"},
        {"event": "damaged"},
        {"event": "timeout"},
        {"event": "arrived", "id": 241, "bytes": "0001"},
    ],
)
def test_an_event_of_a_script_can_be_written_and_read(row):
    assert row_of(event_of(row)) == row


KINDS = [
    {"name": "list"},
    {"name": "download", "bus": "uart", "inputs": {"type": 2, "counter": 1, "size": 130}, "block": 80},
    {"name": "download", "bus": "i2c", "inputs": {"type": 2, "counter": 1}, "block": 60},
    {"name": "download", "bus": "can", "inputs": {"type": 2, "counter": 2, "size": 0}},
    {"name": "upload", "inputs": {"destination": 3}, "bytes": bytes(range(150)).hex(), "block": 80},
    {"name": "erase", "inputs": {"type": 2, "counter": 1, "all": 1}},
    {"name": "format"},
    {"name": "program_copy", "inputs": {"program": 3}},
    {"name": "program_information", "inputs": {"program": 3}},
]  # fmt: skip
OUTCOMES = st.sampled_from(["done", "done", "done", "sent", "refused", "timeout"])
MOST_STEPS = 2000
RESULTS = (
    "done", "refused", "busy", "timeout", "failed", "length", "rounds", "checksum", "limit",
)  # fmt: skip


@given(st.data(), st.sampled_from(KINDS))
@settings(max_examples=150)
def test_every_procedure_ends_once_the_device_is_silent(boot, data, request):
    """Each request has an outcome, frames have any content, and time advances in leaps."""
    procedure, now, pending = procedure_of(boot, request), 0, None
    for step in range(MOST_STEPS):
        sent = procedure.next(now)
        assert not (sent and pending), "a request before the outcome of another"
        pending = sent or pending
        if procedure.result:
            break
        is_silent = step >= 40
        if pending is None and is_silent:
            now = procedure.deadline
            continue
        now += 0 if is_silent else data.draw(st.sampled_from([0, 1, 50, 600, 20_000]))
        if pending is None:
            piece = data.draw(st.binary(min_size=20, max_size=20))
            number = data.draw(st.integers(0, 9)).to_bytes(2, "little")
            procedure.event(now, Arrived(241, number + piece, {}))
        else:
            procedure.event(now, outcome(boot, data, pending, is_silent))
            pending = None
    assert procedure.result in RESULTS
    assert (procedure.next(now), procedure.deadline) == (None, None)
    transferred, total = procedure.progress
    assert transferred >= len(procedure.data)
    if procedure.result == "done" and total is not None:
        assert transferred == total


def outcome(link, data, request, is_silent):
    kind = "timeout" if is_silent else data.draw(OUTCOMES)
    if kind == "refused":
        return Refused(request.id, 1)
    if kind == "timeout":
        return Timeout(request.id, 1)
    if kind == "sent" and request.kind == "telecommand":
        return Sent(request.id, 1)
    length = link.frames[request.id] if request.kind == "telemetry" else 0
    numbers = st.sampled_from([0, 0, 1, 2, 130, 255])
    frame = data.draw(st.lists(numbers, min_size=length, max_size=length))
    return Done(request.id, 1, bytes(frame))

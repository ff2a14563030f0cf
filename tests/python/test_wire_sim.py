"""Sessions with a simulated device work without and with faults on the line.

The time is simulated too, so that time-outs take no real time.
"""

from __future__ import annotations

from random import Random

import pytest

from icdgen.protocol import facts
from icdgen.protocol.procedures import Send
from tests.python import packages
from tests.sim.port import DevicePort, Refusing

RESETS = ("Reset", "Run Selected Program")


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


def session(shipped, node: str = "cubeacp", **options):
    port = DevicePort(packages.shipped(), node, **options)
    wire = shipped.module("wire")
    return (
        wire.Session(
            shipped.module(node).LINK, port.write, port.read, clock=port.clock
        ),
        port,
    )


def test_the_package_identifies_its_node(shipped, wire):
    acp = shipped.module("cubeacp")
    talking, _ = session(shipped)
    assert wire.identify(acp.LINK, talking.get(acp.Identification).to_bytes()).matches


def test_all_telemetry_can_be_requested(shipped):
    acp = shipped.module("cubeacp")
    talking, _ = session(shipped)
    for _, message in acp.TELEMETRY.items():
        assert isinstance(talking.get(message), message)


def test_every_setting_can_be_written_and_read_back(shipped):
    acp = shipped.module("cubeacp")
    talking, _ = session(shipped)
    settings = [
        message
        for _, message in acp.TELECOMMANDS.items()
        if message.KIND == "configuration"
    ]
    clock = {"Current Unix Time"}  # advances between the two requests
    assert len(settings) > 20
    for message in settings:
        setting = message.from_bytes(message().to_bytes())
        for info in message.FIELDS:
            if info.type in ("uint", "int") and info.const is None:
                setattr(setting, info.attribute, 1)
        talking.send(setting)
        if message.NAME not in clock:
            assert talking.get(message) == setting


def test_every_telecommand_has_an_outcome(shipped, wire):
    acp, icd = shipped.module("cubeacp"), packages.shipped()
    # Only the bootloader supports the upload.
    (upload,) = (
        p
        for p in facts.of(icd, icd.node("bootloader")).procedures
        if p.name == "upload"
    )
    uploads = {step.message.name for step in upload.steps if isinstance(step, Send)}
    talking, _ = session(shipped)
    for _, message in acp.TELECOMMANDS.items():
        if message.NAME not in RESETS:
            try:
                talking.send(message())
            except wire.RefusedError as error:
                assert error.event.reason == (
                    "Invalid TC" if message.NAME in uploads else "Incorrect Parameter"
                )
    assert talking.get(acp.Identification).node_type == acp.NODE_TYPE


def test_a_refusal_and_a_silent_node_are_errors(shipped, wire):
    acp = shipped.module("cubeacp")
    talking, _ = session(shipped, faults=["nack=100%"])
    with pytest.raises(wire.RefusedError):
        talking.send(acp.ClearErrors())
    talking, port = session(shipped, faults=["drop=100%"])
    with pytest.raises(wire.ReplyTimeoutError, match="4 attempts"):
        talking.get(acp.Identification)
    assert 3.9 < port.clock() < 4.1


@pytest.mark.parametrize(
    "faults",
    ["corrupt=10%", "late=10%", "cut=10%", "noise=20%", "duplicate=30%", "repeat=10%"],
)
def test_a_session_does_not_hang_and_receives_telemetry_over_a_faulty_line(
    shipped, wire, faults
):
    acp = shipped.module("cubeacp")
    talking, port = session(shipped, faults=[faults], seed=3, late=700)
    replies = 0
    for _ in range(100):
        try:
            talking.send(acp.ClearErrors(), repeat=True)
            replies += isinstance(
                talking.get(acp.EstimatedAttitudeAngles), acp.EstimatedAttitudeAngles
            )
        except (wire.RefusedError, wire.ReplyTimeoutError):
            continue
    assert replies >= 95
    assert port.clock() < 600


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "file.bin"
    path.write_bytes(Random(1).randbytes(61_441))
    return path


@pytest.mark.parametrize("loss", [0, 1, 10, 30])
def test_a_file_arrives_byte_for_byte(shipped, wire, file, loss):
    talking, _ = session(
        shipped,
        files=[f"2:5={file}"],
        faults=[f"drop={loss}%@packet"] * bool(loss),
        seed=loss,
    )
    acp = shipped.module("cubeacp")
    (entry,) = talking.run(acp.procedures.List()).entries
    assert (entry.file_type, entry.file_ctr, entry.file_size) == (2, 5, 61_441)
    progress = []
    download = acp.procedures.Download(type=2, counter=5, size=entry.file_size)
    talking.run(download, lambda *now: progress.append(now))
    assert download.data == file.read_bytes()
    assert [size for size, _ in progress] == [0, 20480, 40960, 61440, 61441]


@pytest.mark.parametrize("loss", [0, 1, 10, 30])
def test_a_program_arrives_byte_for_byte(shipped, wire, file, tmp_path, loss):
    faults = [
        f"drop={loss}%@upload",
        f"corrupt={loss / 10}%@acknowledge",
        f"late={loss / 10}%@acknowledge",
    ]
    talking, _ = session(
        shipped,
        "bootloader",
        uploads=tmp_path,
        faults=faults * bool(loss),
        seed=loss,
        boot=10**9,
    )
    upload = shipped.module("bootloader").procedures.Upload(3, file.read_bytes())
    talking.run(upload)
    assert upload.progress == (61_441, 61_441)
    (program,) = tmp_path.glob("3.bin")
    assert program.read_bytes()[:61_441] == file.read_bytes()


def test_a_download_that_loses_every_packet_fails(shipped, wire, file):
    talking, _ = session(shipped, files=[f"2:5={file}"], faults=["drop=100%@packet"])
    with pytest.raises(wire.FailedError, match="rounds"):
        talking.run(shipped.module("cubeacp").procedures.Download(2, 5, 100))


def refusing(shipped, name: str, times: int, code: int = 0x55):
    """Return a session with a bootloader that refuses a telecommand, its events, and
    the port.
    """
    events, boot = [], shipped.module("bootloader")
    port = Refusing(
        packages.shipped(),
        "bootloader",
        getattr(boot, name).ID,
        code,
        times,
        boot=10**9,
    )
    talking = shipped.module("wire").Session(
        boot.LINK, port.write, port.read, clock=port.clock, on_event=events.append
    )
    return talking, events, port


@pytest.mark.parametrize("times", [1, 3])
def test_a_refusal_with_an_unknown_code_is_reported_and_the_telecommand_repeated(
    shipped, wire, times
):
    talking, events, port = refusing(shipped, "InitiateFileUpload", times)
    talking.run(shipped.module("bootloader").procedures.Upload(3, bytes(100)))
    assert [(event.code, event.reason) for event in events] == [(0x55, None)] * times
    assert port.acknowledged == times + 1


def test_repeated_refusals_with_an_unknown_code_are_a_time_out(shipped, wire):
    talking, events, port = refusing(shipped, "InitiateFileUpload", 100)
    with pytest.raises(wire.FailedError, match="timeout") as caught:
        talking.run(shipped.module("bootloader").procedures.Upload(3, bytes(100)))
    assert caught.value.result == "timeout" and {event.code for event in events} == {
        0x55
    }
    assert (
        len(events)
        == port.acknowledged
        == 1 + shipped.module("bootloader").LINK.settings.retries
    )


def test_a_telecommand_refused_with_a_known_code_is_not_repeated(shipped, wire):
    talking, events, port = refusing(shipped, "InitiateFileUpload", 1, code=2)
    with pytest.raises(wire.FailedError) as caught:
        talking.run(shipped.module("bootloader").procedures.Upload(3, bytes(100)))
    assert (
        caught.value.event.code,
        caught.value.event.reason,
        events,
        port.acknowledged,
    ) == (2, "Incorrect Length", [], 1)


def test_unsolicited_logs_are_reported(shipped, wire):
    events = []
    talking, port = session(shipped)
    talking._on_event = events.append
    acp = shipped.module("cubeacp")
    mask = bytes([1]) + bytes(9)
    message = wire.LogMessage.encode(
        acp.LINK, mask, [bytes(b.length) for b in acp.LINK.mask.selected(mask)]
    )
    port.line._send(0, "log", message)
    talking.get(acp.Identification)
    assert [type(event) for event in events] == [wire.Log]

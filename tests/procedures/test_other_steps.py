"""A simulated device follows from the steps of any procedure: other maps, other numbers
of packets, packets stored at once, and refused telecommands.

The ICD is ``other_steps.yaml``.
"""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest
from icdgen_runtime.wire.failures import FailedError
from icdgen_runtime.wire.procedures import Procedure
from icdgen_runtime.wire.session import Session

from icdgen.procedures.effects import default_effect
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from icdgen.sim import run
from icdgen.vectors import protocol
from icdgen.vectors.wire.recording import RecordedDevice, record
from tests.conformance.icds import icd_of

ICD = icd_of([Path(__file__).with_name("other_steps.yaml")])
FACTS = facts.of(ICD, ICD.node("store"))
LINK = link_of(ICD, FACTS)
SIZES = [0, 1, 8, 160, 161, 1000]  # bytes; a packet has 8, a block 160
LOSSES = [0.0, 0.1, 0.3]


@pytest.mark.parametrize("loss", LOSSES)
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("is_known", [True, False], ids=["known", "unknown"])
def test_an_object_is_read(size, loss, is_known):
    content = Random(size).randbytes(size)
    device = RecordedDevice(FACTS, "uart", Random(f"{size} {loss}"), loss)
    device.device.objects.put("read", (3,), content)
    inputs = {"number": 3, "size": size} if is_known else {"number": 3}
    request = {"name": "read", "inputs": inputs}
    _, procedure = record(LINK, request, device.respond)
    assert (procedure.result, procedure.data) == ("done", content)


@pytest.mark.parametrize("loss", LOSSES)
@pytest.mark.parametrize("size", SIZES)
def test_an_object_is_written(size, loss):
    content = Random(size).randbytes(size)
    device = RecordedDevice(FACTS, "uart", Random(f"{size} {loss}"), loss)
    request = {"name": "write", "inputs": {"number": 5}, "bytes": content.hex()}
    _, procedure = record(LINK, request, device.respond)
    assert procedure.result == "done"
    assert device.device.objects.content_of("write", (5,)) == content


def test_a_procedure_of_unknown_size_has_vectors_also_if_its_blocks_are_small(tmp_path):
    text = Path(__file__).with_name("other_steps.yaml").read_text(encoding="utf-8")
    path = tmp_path / "other_steps.yaml"
    path.write_text(text.replace("size: 160", "size: 32"), encoding="utf-8")
    icd = icd_of([path])
    cases = protocol.cases(icd, icd.node("store"))
    results = {
        case.why: case.answer["steps"][-1]["result"]
        for case in cases
        if case.why.startswith("read: ") and "of unknown number" in case.why
    }
    assert results["read: 32 bytes of unknown number"] == "done", results


class SteppedDevice:
    """A simulated device in memory and a session with it, in simulated time."""

    def __init__(self, **options) -> None:
        self.line, _ = run.build_device(
            ICD, "store", run.Options(every=0, busy=0, **options)
        )
        self.now, self.sent = 0.0, []
        self.session = Session(LINK, self._write, self._read, clock=lambda: self.now)

    def _write(self, data: bytes) -> None:
        self.line.received(round(self.now * 1000), data)
        self.sent += self.line.pieces(round(self.now * 1000))

    def _read(self, seconds: float) -> bytes:
        self.now += 0 if self.sent else seconds
        return self.sent.pop(0) if self.sent else b""

    def run(self, name: str, data: bytes = b"", **inputs: int) -> Procedure:
        return self.session.run(Procedure(LINK, name, inputs, data))

    def files(self) -> list[tuple[int, int, int]]:
        """Return number, size and checksum of each file in the list."""
        entries = self.run("list").entries
        return [(each.number, each.length, each.sum) for each in entries]


def test_a_file_that_was_written_is_listed_and_read():
    device = SteppedDevice()
    content = bytes(range(200))
    device.run("write", content, number=4)
    device.run("write", b"short", number=2)
    assert [file[:2] for file in device.files()] == [(4, 200), (2, 5)]
    assert device.run("read", number=4, size=200).data == content
    assert device.run("read", number=2).data == b"short"


def test_a_file_that_is_written_again_is_replaced():
    device = SteppedDevice()
    device.run("write", bytes(500), number=4)
    device.run("write", b"new", number=4)
    assert [file[:2] for file in device.files()] == [(4, 3)]
    assert device.run("read", number=4).data == b"new"


def test_files_of_the_user_are_named_by_the_inputs_of_the_icd(tmp_path):
    (tmp_path / "file").write_bytes(b"123456789")
    device = SteppedDevice(files=[f"9={tmp_path / 'file'}"])
    assert device.run("read", number=9, size=9).data == b"123456789"
    # The checksum of files is the one that a procedure verifies.
    assert device.files() == [(9, 9, 0x29B1)]


def test_a_copy_is_another_file():
    device = SteppedDevice()
    device.run("write", b"content", number=1)
    device.run("copy", number=1)
    device.run("write", b"changed", number=1)
    assert device.run("read", number=7).data == b"content"


def test_a_telecommand_is_refused_if_nothing_else_can_report_its_failure():
    with pytest.raises(FailedError, match="refused"):
        SteppedDevice().run("copy", number=1)


def test_a_failure_that_telemetry_reports_ends_the_procedure():
    with pytest.raises(FailedError, match="failed"):
        SteppedDevice().run("read", number=1)


def test_without_an_effect_in_the_icd_a_procedure_has_objects_of_its_own():
    defaults = {each.name: default_effect(each) for each in FACTS.procedures}
    assert {
        name: (effect.verb, effect.kind, effect.names)
        for name, effect in defaults.items()
    } == {
        "read": ("read", "read", ("number",)),  # not `size`, which is never sent
        "write": ("write", "write", ("number",)),
        "list": ("", "list", ()),
        "copy": ("", "copy", ("number",)),
    }

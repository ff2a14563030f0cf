"""Files that the user gives to the device, the index of them, and stored programs."""

from __future__ import annotations

import os
import time
from datetime import UTC, datetime

import pytest
from icdgen_runtime.wire.files import read_index
from icdgen_runtime.wire.times import DosTime, dos_time_unpack

from icdgen.errors import UserError
from icdgen.procedures.run import checksum_of
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of_node
from icdgen.sim.files import read_file, saver
from icdgen.sim.storage import DeviceStorage, Object
from tests.conformance.icds import icd_of
from tests.limits import assert_limits

ICD = icd_of()
NODE = ICD.node("cubeacp")
FACTS = facts.of(ICD, NODE)
LINK = link_of_node(ICD, NODE)


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "a=b.bin"
    path.write_bytes(b"content")
    seconds = datetime(2021, 3, 4, 5, 6, 8, tzinfo=UTC).timestamp()
    os.utime(path, (seconds, seconds))
    return path


def test_a_file_has_kind_key_content_and_time(path):
    kind, key, stored = read_file(ICD, NODE, f" 2 : 0x07={path}")
    assert (kind, key, stored.data) == ("file", (2, 7), b"content")
    assert dos_time_unpack(LINK, stored.time) == DosTime(2021, 3, 4, 5, 6, 8)


def test_the_time_of_a_file_does_not_depend_on_the_time_zone(path, monkeypatch):
    monkeypatch.setenv("TZ", "XYZ-5")
    time.tzset()
    try:
        stored = read_file(ICD, NODE, f"2:7={path}")[2]
    finally:
        monkeypatch.undo()
        time.tzset()
    assert dos_time_unpack(LINK, stored.time) == DosTime(2021, 3, 4, 5, 6, 8)


def test_a_time_that_the_format_cannot_have_is_0(path):
    seconds = datetime(1979, 12, 31, tzinfo=UTC).timestamp()
    os.utime(path, (seconds, seconds))
    assert read_file(ICD, NODE, f"2:7={path}")[2].time == 0


@pytest.mark.parametrize("text", ["2:7", "2:7=", "2={}", "2:7:1={}", "256:7={}"])
def test_another_notation_is_refused_with_the_right_one(path, text):
    text = text.format(path)
    with pytest.raises(UserError) as refused:
        read_file(ICD, NODE, text)
    assert str(refused.value).startswith(f"`{text}` is no file of the device")
    assert refused.value.help == "TYPE:COUNTER=PATH, such as TYPE:COUNTER=log.bin"


def test_numbers_have_the_bits_of_their_field(path):
    def is_accepted(number: int) -> bool:
        try:
            return read_file(ICD, NODE, f"2:{number}={path}")[1] == (2, number)
        except UserError:
            return False

    assert_limits(is_accepted, least=0, most=255)


def test_the_index_file_and_a_missing_file_are_refused(path):
    number = FACTS.index.file_type
    with pytest.raises(UserError, match="the index file is made of the others"):
        read_file(ICD, NODE, f"{number}:0={path}")
    with pytest.raises(UserError) as refused:
        read_file(ICD, NODE, f"2:7={path}x")
    assert refused.value.help == "check the path after the ="


def test_a_node_without_files_refuses_each():
    node = next(node for node in ICD.nodes if not facts.of(ICD, node).procedures)
    with pytest.raises(UserError, match="the ICD describes no files"):
        read_file(ICD, node, "2:7=x")


def test_the_index_has_an_entry_for_each_file_in_the_order_of_creation():
    form, log = FACTS.index, FACTS.log_file
    algorithm = FACTS.checksum_of_files
    storage = DeviceStorage()
    storage.provide_index(LINK, "file", algorithm)
    entry = bytes(range(1, 60))
    storage.objects_of("file")[(9, 200)] = Object(bytearray(b"abc"), 0x12345678)
    storage.objects_of("file")[(log.file_type, 4)] = Object(bytearray(entry), 1)
    data = storage.content_of("file", (form.file_type, 0))
    first, second = read_index(LINK, data)[0]
    size = form.fields["meta"].bytes
    assert (first.type, first.counter, first.size, first.time) == (
        9,
        200,
        3,
        0x12345678,
    )
    assert first.checksum == checksum_of(algorithm, b"abc")
    assert first.meta == bytes(size)
    mask = entry[LINK.log_file.mask_at :][: LINK.mask.size]
    assert second.meta == mask[:size].ljust(size, b"\0")
    assert (second.type, second.counter, second.size) == (log.file_type, 4, 59)


def test_only_the_index_file_is_computed():
    storage = DeviceStorage()
    storage.provide_index(LINK, "file", None)
    storage.put("file", (9, 1), b"abc")
    assert storage.content_of("file", (9, 1)) == b"abc"
    assert storage.content_of("file", (9, 2)) is None
    assert storage.content_of("program", (FACTS.index.file_type, 0)) is None


def test_stored_programs_have_their_numbers_as_name_and_replace_earlier_ones(tmp_path):
    folder = tmp_path / "new" / "uploads"
    save = saver(folder)
    save("program", (3,), b"old")
    save("program", (3,), b"new")
    save("file", (2, 7), b"")
    assert {p.name: p.read_bytes() for p in folder.iterdir()} == {
        "3.bin": b"new",
        "2-7.bin": b"",
    }
    saver(folder)("program", (4,), b"x")  # the folder may exist
    assert saver(None) is None


def test_uploads_to_a_file_are_refused(path):
    with pytest.raises(UserError) as refused:
        saver(path)
    assert str(refused.value).startswith(f"{path} is not a folder")

"""Requests of the vectors meet the limits of time-outs, masks, packed times and files."""

from __future__ import annotations

from random import Random

import pytest

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of_node
from icdgen.runtime_objects.scripts import client
from icdgen.vectors.wire import files, i2c, logs, waits
from tests.conformance.icds import icd_of

ICD = icd_of()
NODE = ICD.node("cubeacp")
FACTS = facts.of(ICD, NODE)
LINK = link_of_node(ICD, NODE)
SCRIPTS = dict(waits.scripts(LINK, FACTS))


@pytest.mark.parametrize("bus", ["uart", "can"])
def test_a_client_without_a_response_reacts_exactly_at_each_time_limit(bus):
    script = SCRIPTS[f"{bus}: silence"]
    patience, tries = FACTS.client.reply_timeout, FACTS.client.retries + 1
    steps = client(LINK, script)["steps"]
    times = [row["at"] for row in script["script"]]
    assert times == sorted(times) and len(steps) == 2 * tries + 2
    reactions = {
        row["at"]: bool(step["out"]) or bool(step["events"])
        for row, step in zip(script["script"], steps, strict=True)
    }
    for attempt in range(1, tries + 1):
        assert reactions[attempt * patience - 1] is False
        assert reactions[attempt * patience] is True
    assert [event["event"] for step in steps for event in step["events"]] == ["timeout"]
    assert steps[-2]["events"][0]["attempts"] == tries
    assert steps[-1] == {"out": [], "events": [], "deadline": None}


@pytest.mark.parametrize(
    ("name", "early"),
    [("a millisecond before its time is over", 1), ("when its time is over", 0)],
)
def test_a_telecommand_is_polled_until_its_time_is_over(name, early):
    script = SCRIPTS[f"i2c: not processed {name}"]["script"]
    pause, end = FACTS.client.poll_interval, 1 + FACTS.client.poll_timeout
    times = [row["at"] for row in script]
    assert times[:6] == [0, 1, pause, 1 + pause, 2 + pause, 1 + 2 * pause]
    assert times[-2:] == [end - early, end - early + pause]
    steps = client(LINK, SCRIPTS[f"i2c: not processed {name}"])["steps"]
    ended = [any(e["event"] == "timeout" for e in step["events"]) for step in steps]
    assert ended.index(True) == len(script) - 1 - (not early)


def test_masks_are_empty_single_some_and_full():
    layout, masks = FACTS.mask, logs.masks(FACTS)
    numbers = [int.from_bytes(mask, "little") for mask in masks]
    assert all(len(mask) == layout.size for mask in masks)
    assert numbers[0] == 0 and numbers[-1] == (1 << 8 * layout.size) - 1
    single = {n.bit_length() - 1 for n in numbers[1:-2]}
    assert all(n.bit_count() == 1 for n in numbers[1:-2])
    assigned = sorted(layout.bits)
    free = sorted(set(range(8 * layout.size)) - set(assigned))
    short = {b for b in assigned if layout.bits[b].length < layout.slot_bytes}
    assert single == {*assigned[::7], *short, *free[:1], *free[-1:]}
    assert 1 < numbers[-2].bit_count() < 8 * layout.size


def test_logs_are_cut_at_the_ends_of_mask_and_file():
    requests = list(logs.requests(LINK, FACTS, Random(1)))
    sizes = [
        len(r["bytes"]) // 2
        for _, r in requests
        if r["op"] == "log_decode" and r["bytes"]
    ]
    mask = FACTS.mask.size
    assert {mask - 1, mask, mask + 1, max(sizes), max(sizes) - 1} <= set(sizes)
    for why, request in requests:
        if why.endswith(" bytes") and "bytes" in request:
            assert int(why.split()[0]) >= len(request["bytes"]) // 2
    encoded = [r for w, r in requests if w == "two entries"]
    assert len(encoded) == len(logs.masks(FACTS))
    assert {
        tuple((e["seconds"], e["milliseconds"]) for e in r["entries"]) for r in encoded
    } == {((0, 0), (0xFFFFFFFF, 999))}


def test_packed_times_have_each_single_bit_and_the_ends():
    values = [
        r["value"]
        for _, r in files.requests(LINK, FACTS, Random(1))
        if r["op"] == "dos_time" and "value" in r
    ]
    assert {0, 0xFFFFFFFF, 0x00210000, *(1 << bit for bit in range(32))} <= set(values)
    assert len(values) == 3 + 32 + 20 and max(values) == 0xFFFFFFFF


def test_an_index_file_is_cut_at_the_ends_of_its_entries():
    requests = [r for _, r in files.requests(LINK, FACTS, Random(1))]
    sizes = [len(r["bytes"]) // 2 for r in requests if r["op"] == "index_decode"]
    size = FACTS.index.entry_bytes
    assert sizes == [0, 1, size, 3 * size - 1, 3 * size]
    encoded = [r["entries"] for r in requests if r["op"] == "index_encode"]
    assert [len(entries) for entries in encoded] == [3, 1, 1]
    for entry in encoded[0]:
        for role, place in FACTS.index.fields.items():
            value = entry[role]
            if role == "meta":
                assert len(value) == 2 * place.bytes
            else:
                assert 0 <= value < 1 << 8 * place.bytes
    assert encoded[2][0]["counter"] == 256


def test_replies_on_i2c_come_complete_short_and_with_one_wrong_bit():
    requests = list(i2c.requests(LINK, FACTS, Random(1)))
    replies = [r for _, r in requests if r["op"] == "i2c_reply"]
    for good, short, wrong in zip(*[iter(replies)] * 3, strict=True):
        data = bytes.fromhex(good["bytes"])
        message = FACTS.telemetry[good["id"]]
        assert len(data) == message.length + good["crc"]  # CRC-8
        assert bytes.fromhex(short["bytes"]) == data[:-1]
        assert bytes.fromhex(wrong["bytes"]) == bytes([data[0] ^ 1]) + data[1:]
    commands = [r for _, r in requests if r.get("kind") == "telecommand"]
    assert len({r["id"] for r in commands}) == 5
    assert {r["crc"] for r in commands} == {False, True}

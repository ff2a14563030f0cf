"""Scripts of a procedure end as their purpose states, at each limit of its ICD."""

from __future__ import annotations

from functools import cache

import pytest

from icdgen.protocol import facts
from icdgen.runtime_objects import reference
from icdgen.runtime_objects.links import link_of_node
from icdgen.vectors.wire import procedures
from tests.conformance.icds import icd_of

NODE = "bootloader"


icd = cache(icd_of)


@cache
def procedure_facts():
    return facts.of(icd(), icd().node(NODE))


def procedure_named(name):
    return next(each for each in procedure_facts().procedures if each.name == name)


@cache
def scripts_of(name):
    """Return the scripts of a procedure by their purpose."""
    link = link_of_node(icd(), icd().node(NODE))
    procedure = procedure_named(name)
    return dict(procedures._Scripts(link, procedure_facts(), procedure).all())


def answer(why, name="download"):
    return reference.answer(icd(), {**scripts_of(name)[why], "node": NODE})


def result(why):
    return answer(why)["steps"][-1]["result"]


RESULTS = {
    "refused for ever": "refused",
    "busy for ever": "busy",
    "timeout for ever": "timeout",
    "damaged for ever": "timeout",
    "telemetry: refused": "refused",
    "telemetry: timeout": "timeout",
    "the first acknowledge is damaged": "done",
    "the device reports a failure": "failed",
    "Download Block Ready: nothing new a millisecond before its time is over": "timeout",
    "Download Block Ready: nothing new when its time is over": "timeout",
    "Download Block Ready: done when its time is over": "done",
    "the time is over": "limit",
    "no bytes": "done",
    "less than announced": "length",
    "the smallest blocks": "done",
    "a block is too long": "length",
    "packets of another block": "done",
    "the same packet for ever over uart": "done",
    "the same packet for ever over can": "rounds",
    "there is nothing": "failed",
    "a checksum that is wrong once": "done",
    "a checksum that is wrong for ever": "checksum",
    "no packet arrives": "rounds",
    "a map in several messages, 10% lost": "done",
    **{f"{loss}% lost over {bus}": "done"
       for loss in (0, 30) for bus in ("uart", "i2c", "can")},
}  # fmt: skip


@pytest.mark.parametrize("why", RESULTS)
def test_a_script_ends_as_its_purpose_states(why):
    assert result(why) == RESULTS[why]


def test_the_time_of_a_procedure_is_over_one_millisecond_after_its_limit():
    script = scripts_of("download")["the time is over"]["script"]
    time = procedure_named("download").time
    assert [row["at"] for row in script] == [0, time, time + 1]
    results = [step["result"] for step in answer("the time is over")["steps"]]
    assert results == [None, None, "limit"]


@pytest.mark.parametrize(
    ("name", "most"), [("type", 255), ("counter", 255), ("size", 16777216)]
)
def test_an_input_has_its_ends_and_the_next_number_is_refused(name, most):
    for number in (0, most):
        assert answer(f"{name} is {number}")["ok"]
    beyond = answer(f"{name} is {most + 1}, which is not supported")
    assert (beyond["ok"], beyond["error"]) == (False, "range")
    # Nothing is below 0.
    assert f"{name} is -1, which is not supported" not in scripts_of("download")


def test_each_supported_value_is_tried_and_its_neighbours_are_refused():
    scripts = scripts_of("program_copy")
    tried = [why for why in scripts if why.startswith("program is ")]
    values = [int(why.split()[2].strip(",")) for why in tried]
    assert values == [3, 4, 5, 6, 7, 8, 9, 2, 10]
    assert [answer(why, "program_copy")["ok"] for why in tried] == [True] * 7 + [
        False
    ] * 2


def test_an_optional_input_can_be_missing():
    assert "size" not in scripts_of("download")["size is not given"]["inputs"]
    assert answer("size is not given")["ok"]
    assert "type is not given" not in scripts_of("download")


def test_bytes_of_unknown_number_are_none_some_or_exactly_a_block():
    blocks, scripts = procedure_named("download").blocks, scripts_of("download")
    # Four packets in a block; the last of all packets is not complete.
    size = 6 * blocks.packet_bytes + blocks.packet_bytes // 2 + 1
    for count in (0, size, 4 * blocks.packet_bytes):
        assert result(f"{count} bytes of unknown number") == "done"
    request = scripts["0% lost over uart"]
    assert request["block"] == 4 * blocks.packet_bytes
    assert request["inputs"]["size"] == size
    assert scripts["less than announced"]["inputs"]["size"] == size + 1
    assert scripts["the smallest blocks"]["block"] == 1

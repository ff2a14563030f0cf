"""Error codes that the ICD does not have: they are kept and told, and the request is
sent again.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from icdgen.errors import UserError
from icdgen.icd.layout_nodes import overlay_of
from icdgen.protocol import transfer
from icdgen.sim.control import _check_wave, raw_value_of
from icdgen.sim.values import Values
from tests.sim.device import ICD
from tests.sim.port import Refusing
from tests.sim.reference import Session

ODD = 0x55
NODE = ICD.node("bootloader")


class Talking(Session):
    """A session in the time of its port."""

    @property
    def now(self) -> int:
        return int(self.port.now)


def uploading(code: int, times: int):
    """What became of an upload whose first telecommand is refused; what the session
    told; and the port.
    """
    heard = []
    step = ICD.protocol_of(NODE)["file_transfer"]["upload"]["initiate"]["message"]
    id = next(m.id for m in ICD.messages_of(NODE) if m.name == step)
    port = Refusing(ICD, NODE.name, id, code, times, boot=10**9)
    talking = Talking(ICD, NODE, port, on_event=heard.append)
    return (
        talking.run(transfer.Upload(talking.known, 3, bytes(100))),
        heard,
        port.acknowledged,
    )


@pytest.mark.parametrize("times", [1, 3])
def test_a_refusal_that_the_icd_does_not_know_is_told_and_asked_again(times):
    result, heard, acknowledged = uploading(ODD, times)
    assert result == "done"
    assert [(event["event"], event["code"], event["reason"]) for event in heard] == [
        ("refused", ODD, None)
    ] * times
    assert acknowledged == times + 1


def test_a_refusal_that_the_icd_does_not_know_is_a_time_out_at_last():
    result, heard, acknowledged = uploading(ODD, 100)
    assert result == "timeout"
    assert [event["code"] for event in heard] == [ODD] * 4 and acknowledged == 4


def test_a_view_is_not_set_and_follows_what_is():
    node = ICD.node("cubeacp")
    frame = next(
        m for m in ICD.messages_of(node) if m.name == "Estimated Attitude Angles"
    )
    own = frame.layout.fixed[0]
    seen = overlay_of(
        replace(own, name="Seen", bits=8, type="int", scale=None, unit=None)
    )
    both = replace(
        frame, layout=replace(frame.layout, fixed=(*frame.layout.fixed, seen))
    )
    values = Values(
        replace(ICD, nodes=tuple(_with(node, frame, both) for node in ICD.nodes)), node
    )
    values.update(both, {own.name: -2})
    assert values.raw(both)["Seen"] == -2
    view = values.icd.longest_frame(both)[-1]
    for wrong in (
        lambda: raw_value_of(both, view, "1"),
        lambda: _check_wave("step 1", view, {"wave": "sine"}),
    ):
        with pytest.raises(UserError, match="an overlay field has no bits of its own"):
            wrong()


def _with(node, frame, other):
    messages = tuple(other if one is frame else one for one in node.messages)
    return replace(node, messages=messages)


def test_a_refusal_that_the_icd_knows_is_not_asked_again():
    code = ICD.protocol_of(NODE)["errors"]["length"]
    assert uploading(code, 1) == ("refused", [], 1)

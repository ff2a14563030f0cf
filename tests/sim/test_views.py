"""Overlay fields of a simulated device."""

from __future__ import annotations

from dataclasses import replace

import pytest

from icdgen.errors import UserError
from icdgen.icd.layout_nodes import overlay_of
from icdgen.sim.control import _check_wave, raw_value_of
from icdgen.sim.values import Values
from tests.sim.device import ICD


def test_an_overlay_field_cannot_be_set_and_follows_its_bits():
    node = ICD.node("cubeacp")
    frame = next(
        m for m in ICD.messages_of(node) if m.name == "Estimated Attitude Angles"
    )
    own = frame.layout.fixed[0]
    seen = overlay_of(
        replace(own, name="Seen", bits=8, type="int", scale=None, unit=None)
    )
    both_fields = replace(
        frame, layout=replace(frame.layout, fixed=(*frame.layout.fixed, seen))
    )
    values = Values(
        replace(
            ICD, nodes=tuple(_with(node, frame, both_fields) for node in ICD.nodes)
        ),
        node,
    )
    values.update(both_fields, {own.name: -2})
    assert values.raw(both_fields)["Seen"] == -2
    view = values.icd.longest_frame(both_fields)[-1]
    for wrong in (
        lambda: raw_value_of(both_fields, view, "1"),
        lambda: _check_wave("step 1", view, {"wave": "sine"}),
    ):
        with pytest.raises(UserError, match="an overlay field has no bits of its own"):
            wrong()


def _with(node, frame, other):
    messages = tuple(
        other if message is frame else message for message in node.messages
    )
    return replace(node, messages=messages)

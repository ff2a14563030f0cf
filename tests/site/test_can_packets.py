"""CAN packets that the decoder of a page shows for a message."""

from __future__ import annotations

import json

import pytest
from icdgen_runtime.wire.can import CanMessage, can_split
from icdgen_runtime.wire.errors import TooLongError, UnsupportedError

from icdgen.backends.html.wire import can_facts
from icdgen.protocol import facts
from tests import links
from tests.conftest import ROOT
from tests.site.javascript import run_script

SCRIPT = ROOT / "templates" / "html" / "packets.js"
SIZES = [0, 1, 7, 8, 9, 14, 15, 21, 22, 1792, 1793]


@pytest.mark.parametrize("kind", ["telecommand", "reply", "request"])
def test_a_message_is_split_and_joined_as_by_the_python_runtime(shipped, kind):
    """A request carries no data, and is not split."""
    link = links.link(shipped, "cubeacp")
    node_facts = facts.of(shipped, shipped.node("cubeacp"))
    source, destination = (1, 2) if kind == "reply" else (2, 1)
    cases = [list((bytes(range(256)) * 8)[:size]) for size in SIZES]
    code = f"""
        const {{ split, join }} = require({json.dumps(str(SCRIPT))});
        const [can, kind, source, destination, cases] = argument;
        return cases.map((data) => {{
            const sent = split(can, kind, 18, source, destination, Uint8Array.from(data));
            const parts = sent.map((one) => ({{ ...one, data: Uint8Array.from(one.data) }})).reverse();
            const {{ messages, open, odd }} = join({{ can }}, parts, () => data.length);
            const joined = messages.map((one) => [one.kind, one.id, [...one.data]]);
            return [sent.map((one) => [one.id, one.data]), joined, open.length + odd];
        }});
    """
    can = json.loads(json.dumps(can_facts(node_facts.can)))
    shown = run_script(code, [can, kind, source, destination, cases])
    for data, (packets, messages, rest) in zip(cases, shown, strict=True):
        message = CanMessage(kind, 18, source, destination, bytes(data))
        try:
            expected = can_split(link, message)
        except (TooLongError, UnsupportedError):
            expected = []
        assert packets == [[packet.id, list(packet.data)] for packet in expected]
        assert messages == ([[kind, 18, data]] if expected else []) and rest == 0

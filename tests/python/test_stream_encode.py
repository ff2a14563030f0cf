"""`stream_encode` refuses unknown header values, such as a misspelt keyword."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.stream import stream_encode

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conftest import ROOT


@pytest.fixture(scope="module")
def link():
    icd = load([ROOT / "examples" / "links" / "mavlink2.yaml"]).icd
    return link_of(icd, facts.of(icd, icd.nodes[0]))


def test_values_that_the_header_does_not_have_are_refused(link):
    id = link.stream.telecommands[0].id
    data = bytes([1]) * link.stream.telecommands[0].most
    assert stream_encode(link, id, data, sequence=7) != stream_encode(link, id, data)
    with pytest.raises(TypeError, match="takes no 'sequense', but sequence, source"):
        stream_encode(link, id, data, sequense=7)

"""Streams of the vectors arrive in pieces that together are the stream."""

from __future__ import annotations

from random import Random

import pytest

from icdgen.vectors.wire import pieces


@pytest.mark.parametrize("size", [0, 1, 2, 4, 5, 6, 40])
def test_a_stream_comes_whole_byte_by_byte_and_cut_at_random_positions(size):
    stream = bytes(range(size))
    whole, single, cut = pieces("noise", stream, Random(size))
    assert whole == ("noise", [stream])
    assert single == ("noise, byte by byte", [bytes([n]) for n in range(size)])
    assert cut[0] == "noise, cut at odd places"
    assert b"".join(cut[1]) == stream
    assert len(cut[1]) == min(5, size) + 1


def test_cuts_at_both_ends_give_empty_pieces():
    cuts = [list(pieces("", b"abcde", Random(seed)))[2][1] for seed in range(20)]
    assert any(cut[0] == b"" for cut in cuts)
    assert any(cut[-1] == b"" for cut in cuts)
    assert any(cut[0] != b"" for cut in cuts)

"""Bounds of procedures: what the limits of an ICD add up to.

`docs/reference/wire-procedures.md` has the same in words.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from icdgen_runtime.wire.file_procedures import RoleProcedure as Procedure
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.programs import ProgramOperation
from icdgen_runtime.wire.transfer import Download, Erase, FileList, Format, Upload


class Bound(NamedTuple):
    """Most requests, most time spent waiting between them (ms), and most bytes or
    entries that the procedure stores.
    """

    requests: int
    waiting: int = 0
    stored: int = 0

    def __add__(self, other: object) -> Bound:
        assert isinstance(other, Bound)
        return Bound(*(a + b for a, b in zip(self, other, strict=True)))

    def __mul__(self, times: object) -> Bound:
        assert isinstance(times, int)
        return Bound(*(times * each for each in self))


def poll(timeout: int, interval: int) -> Bound:
    """Bound of a poll: the last request begins at the end of its time at the latest."""
    return Bound((timeout - 1) // interval + 2, timeout + interval)


def most_of(procedure: Procedure) -> Bound:
    """Return the bound of a procedure.

    Each request can be damaged as often as it can be repeated.
    """
    most = _most_of(procedure, procedure.link)
    return most._replace(requests=most.requests * (1 + procedure.link.settings.retries))


def _most_of(procedure: Procedure, link: Link[Any]) -> Bound:
    files = link.files
    assert files
    if isinstance(procedure, FileList):
        listing = files.list
        assert listing
        # Each file, its repetitions because the advance was lost, and the end.
        frames = listing.max_entries * (1 + link.settings.retries) + 1
        each = poll(listing.timeout, listing.poll_interval) + Bound(1)
        return Bound(1, 0, listing.max_entries) + each * frames
    if isinstance(procedure, Download):
        return _download(procedure, link)
    if isinstance(procedure, Upload):
        return _upload(procedure, link)
    if isinstance(procedure, (Erase, Format)):
        form = files.erase if isinstance(procedure, Erase) else files.format
        assert form
        return Bound(1) + poll(form.timeout, form.poll_interval)
    assert isinstance(procedure, ProgramOperation)
    operation = procedure._form
    return Bound(1) + poll(operation.timeout, operation.poll_interval)


def _download(procedure: Download, link: Link[Any]) -> Bound:
    files, size = link.files, procedure.size
    assert files and files.download and link.hole_map
    form, block = files.download, procedure._block_bytes
    packets = files.packets_of(block)
    load = Bound(1) + poll(form.ready_timeout, form.poll_interval)
    # Each new packet prolongs a round.
    one_round = Bound(
        len(link.hole_map.telecommands) + 1 + packets, (packets + 1) * form.silence
    )
    each = load * (form.rounds + 1) + one_round * form.rounds
    most = form.max_bytes if size is None else size
    return each * (most // block + 1) + Bound(0, 0, most)


def _upload(procedure: Upload, link: Link[Any]) -> Bound:
    files = link.files
    assert files and files.upload and link.hole_map
    form, block = files.upload, procedure._block_bytes
    requests = 3 + files.packets_of(block) + len(link.hole_map.telemetry)
    each = Bound(requests) + poll(form.finalize_timeout, form.poll_interval)
    blocks = -(-len(procedure._data) // block)
    start = Bound(1) + poll(form.erase_timeout, form.poll_interval)
    return start + each * (form.rounds * blocks)

"""Helpers for tests of links: the link of a node, CRCs bit by bit, and log files."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen_runtime.wire.link import CrcForm, Link
from icdgen_runtime.wire.logs import LogWriter

from icdgen.icd import checksum
from icdgen.icd.model import Icd
from icdgen.protocol import facts
from icdgen.protocol.sections import Crc
from icdgen.runtime_objects.links import link_of


def link(icd: Icd, node: str) -> Link:
    return link_of(icd, facts.of(icd, icd.node(node)))


def crc(form: Crc | CrcForm, data: bytes) -> int:
    """Return the CRC by the definition of its parameters, independent of the runtimes."""
    if not data and form.empty is not None:
        return form.empty
    orders = form.reflect_in, form.reflect_out
    return checksum.crc(
        data, form.width, form.polynomial, form.init, *orders, form.xor_out
    )


def log_file(
    link: Link, mask: bytes, entries: Iterable[tuple[int, int, list[bytes]]]
) -> bytes:
    writer = LogWriter(link, mask)
    return writer.header() + b"".join(writer.entry(*entry) for entry in entries)

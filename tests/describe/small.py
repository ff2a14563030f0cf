"""Descriptions of small ICDs that tests give as text."""

from __future__ import annotations

from pathlib import Path

from icdgen.describe import MessageDescription, NodeDescription, describe
from icdgen.loading import load
from tests.icd.files import status, write


def node_of(folder: Path, text: str) -> NodeDescription:
    """Return the node of a text, to which no rule of ``icdgen check`` is applied."""
    result = load([write(folder, text)], check=False)
    assert not result.findings, [finding.message for finding in result.findings]
    return describe(result.icd).nodes[0]


def message_of(
    folder: Path, *fields: str, length: int, head: str = ""
) -> MessageDescription:
    """Return the message `Status` with these fields, behind the sections ``head``."""
    (message,) = node_of(folder, head + status(*fields, length=length)).messages
    return message

"""Which node a log is of."""

from __future__ import annotations

from icdgen.errors import UserError
from icdgen.icd.model import Icd, Node
from icdgen.protocol import facts
from icdgen.values import find_node


def node_of(icd: Icd, name: str | None) -> Node:
    """The node that is meant; without a name the only one that has logs. Raises `icdgen.errors.UserError`."""
    if name is not None:
        return find_node(icd, name)
    able = [node for node in icd.nodes if facts.of(icd, node).log_file is not None]
    if len(able) == 1:
        return able[0]
    names = ", ".join(node.name for node in able)
    raise UserError(
        "it is not said whose log it is" if able else "the ICDs describe no log files",
        f"--node NAME; nodes: {names}" if able else "`protocol.telemetry_log` describes them, see docs/icd-format.md",
    )

"""The link of a node in a generated package."""

from __future__ import annotations

from typing import Any

from tests.python.packages import Package


def link(package: Package, node: str = "cubeacp") -> Any:
    """Of the node that has all of the protocol, unless another one is named."""
    return package.module(node).LINK

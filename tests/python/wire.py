"""Link of a node in a generated package."""

from __future__ import annotations

from typing import Any

from tests.python.packages import Package


def link(package: Package, node: str = "cubeacp") -> Any:
    """Return the link of a node; `cubeacp` uses all features of the protocol."""
    return package.module(node).LINK

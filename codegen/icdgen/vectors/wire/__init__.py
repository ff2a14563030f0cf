"""What the protocol layer is asked: requests made from the protocol facts of a node, a module a theme."""

from collections.abc import Iterator
from typing import Any

Requests = Iterator[tuple[str, dict[str, Any]]]
"""Requests of the testee protocol, each with why it is asked."""

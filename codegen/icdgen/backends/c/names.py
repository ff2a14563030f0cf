"""The C names of messages and enumerations. All names at file scope begin with the name of the declaring node."""

from __future__ import annotations

from typing import Any

from icdgen.describe import EnumDescription
from icdgen.describe.description import Composite
from icdgen.describe.enums import MemberDescription


def stem(one: Composite[Any] | EnumDescription) -> str:
    """``demo_estimated_roll``: stem of the functions and the type."""
    return f"{one.node.name}_{one.name}"


def enumerator(enum: EnumDescription, member: MemberDescription) -> str:
    """``DEMO_MODE_IDLE``"""
    return f"{stem(enum)}_{member.name}".upper()


def constant(message: Composite[Any], name: str) -> str:
    """``DEMO_RESET_MAGIC_NUMBER_CONST``; ``DEMO_RESET_ID``"""
    return f"{stem(message)}_{name}".upper()

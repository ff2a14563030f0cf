"""What functions about the value of a field take, until no module has the flat list of fields."""

from __future__ import annotations

from typing import TypeAlias

from icdgen.icd.layout import FrameField, NodePlace, Scalar
from icdgen.icd.model import Field

AnyField: TypeAlias = Field | NodePlace
"""What functions about a declared field take."""

AnyValue: TypeAlias = AnyField | FrameField | Scalar
"""What functions about the value of a field take: all that gives a raw value its meaning."""

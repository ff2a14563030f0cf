"""What functions about the value of a field take, until no module has the flat list of fields."""

from __future__ import annotations

from typing import TypeAlias

from icdgen.icd.layout import NodePlace
from icdgen.icd.model import Field

AnyField: TypeAlias = Field | NodePlace

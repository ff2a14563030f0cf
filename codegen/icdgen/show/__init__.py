"""ICDs after errata, for machines (`to_json`) and for people (`to_text`): ``icdgen show``."""

from __future__ import annotations

from icdgen.show.machine import SCHEMA, to_json
from icdgen.show.people import to_text

__all__ = ["SCHEMA", "to_json", "to_text"]

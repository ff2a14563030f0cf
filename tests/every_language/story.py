"""Story: an ICD, and facts that users of the generated code rely on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple


class Claim(NamedTuple):
    """One fact that a user relies on, as statements of each language.

    The statements call the generated code and check what it does with ``CHECK(...)``
    in C, ``assert`` in Python and ``assert!`` or ``assert_eq!`` in Rust. A language
    without the feature has no statements.
    """

    fact: str
    c: str = ""
    python: str = ""
    rust: str = ""


@dataclass(frozen=True)
class Story:
    """Claims about one ICD.

    ``icd`` is the text of the ICD, whose node has the name ``node``; ``included`` has
    the texts of the ICDs that it includes, by node. The statements in ``c``, ``python``
    and ``rust`` precede those of each claim, so all claims start from the same values.
    """

    node: str
    icd: str
    claims: tuple[Claim, ...]
    c: str
    python: str
    rust: str
    included: Mapping[str, str] = field(default_factory=dict)

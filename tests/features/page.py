"""Writes docs/reference/features.md from the measured support."""

from __future__ import annotations

from collections.abc import Mapping

from icdgen.backends.html.guide import anchor_of
from tests import documents
from tests.features.data import Feature, page_of, unmeasured
from tests.features.measure import Cell

PAGE = documents.DOCS / "reference" / "features.md"
OUTPUTS = {
    "codec": ("codec", "the reference codec reads frames differently"),
    "c": (
        "C",
        "the generated code differs, and the conformance run compiles it and compares it with the reference codec",
    ),
    "python": ("Python", "as for C"),
    "rust": ("Rust", "as for C"),
    "javascript": ("JavaScript", "as for C, for the decoder of the documentation site"),
    "vectors": ("vectors", "the golden vectors differ"),
    "random": ("random", "random ICDs of the conformance run have it"),
    "mutation": (
        "mutation",
        "there are mutants of it, which the golden vectors must detect",
    ),
    "fuzz": ("fuzz", "the ICDs of the fuzz harnesses have it"),
    "fmt": ("fmt", "`icdgen fmt` formats the example and keeps its meaning"),
    "check": (
        "check",
        "`icdgen check` reports an error if the feature is used wrongly",
    ),
    "diff": ("diff", "`icdgen diff` reports the change"),
    "show": ("show", "`icdgen show` prints something else"),
    "decode": ("decode", "`icdgen decode` prints something else for the same frames"),
    "encode": ("encode", "`icdgen encode` prints something else for the same values"),
    "site": ("site", "the pages of the documentation site differ"),
    "simulator": (
        "simulator",
        "a simulated device with the same values and telecommands responds differently",
    ),
    "log": ("log", "a log of the same bytes, converted to CSV, differs"),
    "numpy": (
        "numpy",
        "`decode_many` and `decode_table` of the generated Python return other columns",
    ),
    "arrow": ("Arrow", "the same log, converted to Parquet, differs"),
    "xtce": (
        "XTCE",
        "the file for ground systems differs, and the feature is kept when it is imported again",
    ),
}

_BEGIN = """\
# Features and outputs

Features of the [ICD format](icd-format.md), and which output supports each.
`python -m tests.features` measures the table. Each feature is tried on its example in the
documents. An output supports the feature (✓) if it accepts the example and its result changes
when the example uses the feature differently. A number refers to the reason below the table why
an output does not support the feature or does not need it. A test fails if the table is not true.
"""


def page(rows: Mapping[str, tuple[Feature, dict[str, Cell]]]) -> str:
    """Return the text of the page, from the features and their measured cells by name."""
    reasons: list[str] = []
    heads = [head for head, _ in OUTPUTS.values()]
    lines = [_BEGIN, f"| | {' | '.join(heads)} |", f"|---|{'---|' * len(heads)}"]
    for feature, cells in rows.values():
        shown = [_shown(feature, output, cells[output], reasons) for output in OUTPUTS]
        lines.append(
            f"| [{feature.name}]({page_of(feature.section)}#{anchor_of(feature.section)}) | {' | '.join(shown)} |"
        )
    lines += [
        "",
        *(
            f"{number}. {reason[0].upper()}{reason[1:]}."
            for number, reason in enumerate(reasons, 1)
        ),
    ]
    lines += (
        ["", f"Not measured yet: {', '.join(unmeasured()).lower()}."]
        if unmeasured()
        else []
    )
    lines += ["", "| output | how support is measured |", "|---|---|"]
    lines += [f"| {head} | {method} |" for head, method in OUTPUTS.values()]
    return "\n".join(lines) + "\n"


def _shown(feature: Feature, output: str, cell: Cell, reasons: list[str]) -> str:
    if cell.has:
        return "✓"
    reason = feature.without.get(output)
    if reason is None:
        return "**no**"
    if reason not in reasons:
        reasons.append(reason)
    return f"({reasons.index(reason) + 1})"

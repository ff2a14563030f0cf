"""docs/reference/features.md, from what was measured."""

from __future__ import annotations

from collections.abc import Mapping

from icdgen.backends.html.guide import anchor_of
from tests import documents
from tests.features.data import Feature, page_of, unmeasured
from tests.features.measure import Cell

PAGE = documents.DOCS / "reference" / "features.md"
OUTPUTS = {
    "codec": ("codec", "the reference codec reads frames otherwise"),
    "c": (
        "C",
        "other code is generated, and the conformance run builds and asks what it makes of an ICD that has the feature",
    ),
    "python": ("Python", "the same"),
    "rust": ("Rust", "the same"),
    "javascript": ("JavaScript", "the same, of the decoder on the documentation site"),
    "vectors": ("vectors", "the golden vectors are others"),
    "random": ("random", "random ICDs of the conformance run have it"),
    "mutation": ("mutation", "there are mutants of it, which the golden vectors must notice"),
    "fuzz": ("fuzz", "the ICDs on which the fuzz harnesses are run in the tests have it"),
    "fmt": ("fmt", "`icdgen fmt` lays the example out, and it means the same"),
    "check": ("check", "`icdgen check` finds the fault if it is said wrongly"),
    "diff": ("diff", "`icdgen diff` tells of the change"),
    "show": ("show", "`icdgen show` prints something else"),
    "decode": ("decode", "`icdgen decode` prints something else of the same frames"),
    "encode": ("encode", "`icdgen encode` makes, or says, something else of the same values"),
    "site": ("site", "the pages of the documentation site are others"),
    "simulator": (
        "simulator",
        "a simulated device, set to the same values and sent the same telecommands, answers something else",
    ),
    "log": ("log", "a log of the same bytes, converted to CSV, says something else"),
    "numpy": ("numpy", "`decode_many` and `decode_table` of the generated Python give other columns"),
    "arrow": ("Arrow", "the same log, converted to Parquet, says something else"),
    "xtce": ("XTCE", "the file for ground systems says something else, which comes back if it is imported"),
}

_BEGIN = """\
# Features and outputs

What the [format](icd-format.md) can say, and whether each output knows it. The table is measured by `python -m tests.features`,
and a test fails if an output lacks a feature without a reason, or has one that it is said to lack. Each feature is tried on its
example in the documents: an output has it (✓) if it works on the example, and says something else when the example says that
feature otherwise.
"""


def page(rows: Mapping[str, tuple[Feature, dict[str, Cell]]]) -> str:
    """The text of the page, of each feature by its name."""
    reasons: list[str] = []
    heads = [head for head, _ in OUTPUTS.values()]
    lines = [_BEGIN, f"| | {' | '.join(heads)} |", f"|---|{'---|' * len(heads)}"]
    for feature, cells in rows.values():
        shown = [_shown(feature, output, cells[output], reasons) for output in OUTPUTS]
        lines.append(
            f"| [{feature.name}]({page_of(feature.section)}#{anchor_of(feature.section)}) | {' | '.join(shown)} |"
        )
    lines += ["", *(f"{number}. {reason[0].upper()}{reason[1:]}." for number, reason in enumerate(reasons, 1))]
    lines += ["", f"Not measured yet: {', '.join(unmeasured()).lower()}."] if unmeasured() else []
    lines += ["", "| output | what is asked of it |", "|---|---|"]
    lines += [f"| {head} | {asked} |" for head, asked in OUTPUTS.values()]
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

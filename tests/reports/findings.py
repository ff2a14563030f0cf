"""Findings that are difficult to print."""

from __future__ import annotations

from icdgen.diagnostics import Finding, Fix, Place, Related

LONG = "x" * 9_000 + "error" + "y" * 1_000
TEXT = f"icdgen: 1\nnode: {{name: demo}}\n\tmessages:\n温度: {{at: 0, bits: 温}}\n{LONG}\nlast"
TEXTS = {"icd/demo.yaml": TEXT}

ERROR = Finding(
    "ICD020",
    "`Voltage` is 100% wrong: it ends, alas",
    Place("icd/demo.yaml", 2, 7, 12),
    "correct it",
)
WARNING = Finding(
    "ICD041", "nothing uses it", Place("icd/demo.yaml", 1, 1, 6), "", "warning"
)
NOTE = Finding(
    "ICD999", "no such rule", Place("a b/größe,1:2.yaml", 7, 3), "two\nlines", "note"
)

_NAME = Place("icd/demo.yaml", 2, 14, 4)
CORRECTED = Finding(
    "ICD040", "no such name", _NAME, "did you mean `demos`?", fix=Fix(_NAME, "demos")
)
TWICE = Finding(
    "ICD050",
    "twice",
    Place("icd/demo.yaml", 4, 12, 4),
    "rename one",
    related=Related(_NAME, "the first of this name"),
)

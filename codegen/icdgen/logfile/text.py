"""CSV and JSON lines."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable
from typing import TextIO

from icdgen.logfile.columns import TIME
from icdgen.logfile.rows import Value, rows
from icdgen.logfile.source import Source

Done = Callable[[int], None]


def to_csv(source: Source, file: TextIO, head: int | None, done: Done) -> None:
    """A line with the names of the columns, then one for each entry (RFC 4180, but for LF)."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow([TIME, *(column.name for column in source.plan.columns)])
    for time, values in rows(source, head, done):
        writer.writerow([time, *(_shown(value) for value in values)])


def to_json_lines(source: Source, file: TextIO, head: int | None, done: Done) -> None:
    """An object for each entry. JSON has no NaN and no infinity: null."""
    names = [column.name for column in source.plan.columns]
    for time, values in rows(source, head, done):
        finite = (None if isinstance(v, float) and not math.isfinite(v) else v for v in values)
        file.write(json.dumps({TIME: time, **dict(zip(names, finite, strict=True))}, ensure_ascii=False) + "\n")


def _shown(value: Value) -> Value:
    return str(value).lower() if isinstance(value, bool) else value

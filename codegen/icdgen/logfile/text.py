"""CSV and JSON lines."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterable, Sequence
from typing import TextIO

from icdgen.logfile.rows import Value


def to_csv(names: Sequence[str], rows: Iterable[Sequence[Value]], file: TextIO) -> None:
    """A line with the names of the columns, then one for each row (RFC 4180, but for LF). What is not there is empty."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(names)
    for values in rows:
        writer.writerow([_shown(value) for value in values])


def to_json_lines(names: Sequence[str], rows: Iterable[Sequence[Value]], file: TextIO) -> None:
    """An object for each row, without what is not there. JSON has no NaN and no infinity: null."""
    for values in rows:
        there = ((name, value) for name, value in zip(names, values, strict=True) if value is not None)
        told = {name: None if isinstance(v, float) and not math.isfinite(v) else v for name, v in there}
        file.write(json.dumps(told, ensure_ascii=False) + "\n")


def _shown(value: Value) -> Value:
    return str(value).lower() if isinstance(value, bool) else value

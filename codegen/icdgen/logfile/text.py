"""Conversion of rows to CSV and JSON lines, in constant memory."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterable, Sequence
from typing import TextIO

from icdgen.logfile.rows import Value


def to_csv(names: Sequence[str], rows: Iterable[Sequence[Value]], file: TextIO) -> None:
    """Write the names of the columns and the rows as CSV: RFC 4180, but with LF.

    Missing values are empty.
    """
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(names)
    for values in rows:
        # Booleans as in JSON: `true`, not Python's `True`
        writer.writerow(
            [
                str(value).lower() if isinstance(value, bool) else value
                for value in values
            ]
        )


def to_json_lines(
    names: Sequence[str], rows: Iterable[Sequence[Value]], file: TextIO
) -> None:
    """Write an object for each row, without missing values.

    NaN and infinity become null, as JSON cannot represent them.
    """
    for values in rows:
        record: dict[str, Value] = {}
        for name, value in zip(names, values, strict=True):
            if isinstance(value, float) and not math.isfinite(value):
                record[name] = None
            elif value is not None:
                record[name] = value
        file.write(json.dumps(record, ensure_ascii=False) + "\n")

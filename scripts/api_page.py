"""Write docs/reference/api.md, the table of the API, from the programs in
docs/reference/api, which a test builds and runs.

python -m scripts.api_page
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple

import yaml

ROOT = Path(__file__).parent.parent
PAGE, FOLDER = (
    ROOT / "docs" / "reference" / "api.md",
    ROOT / "docs" / "reference" / "api",
)
LANGUAGES = {"c": "C", "python": "Python", "rust": "Rust"}
PROGRAMS = {"c": "imu.c", "python": "imu.py", "rust": "imu.rs"}
_MARK = re.compile(r"\s*(?:/\*|//|#) \[(?P<key>\w*)\](?: \*/)?\s*")

BEGIN = """\
# API in each language

The generated API in C, Python and Rust, side by side. Names follow one rule in all languages. The
messages come from [imu.yaml](api/imu.yaml), an ICD with a field of each kind. Each cell is taken
from a program that a test builds and runs: [imu.c](api/imu.c), [imu.py](api/imu.py),
[imu.rs](api/imu.rs). `python -m scripts.api_page` generates this page.

Messages have raw values; physical values are computed when they are read. A split field is
replaced by its parts. Setting a physical value rejects what the field cannot represent; raw
values are checked when the message is encoded. Limits of the ICD are data for `allows`, because
only the device knows when they apply. An error is a status in C (`ICD_ERROR_RANGE`), an exception
in Python (`RangeError`) and a `Result` in Rust (`Error::Range`).
"""
END = """
Complete programs: [C](../guides/driver-in-c.md), [Rust](../guides/rust.md),
[Python](../guides/python.md). [Wire layer](wire.md) describes buses, files and logs. In C,
`imu_receive_state` rejects an event of another message or node with `ICD_ERROR_UNKNOWN_ID`; in
Rust, a message of another node does not compile.
"""


class Row(NamedTuple):
    """Row of the table: a task of the user.

    ``without``: languages without it, with the reason.
    """

    key: str
    does: str
    without: dict[str, str]


def rows() -> list[Row | str]:
    """Return the rows and the headings between them."""
    items: list[Any] = yaml.safe_load((FOLDER / "rows.yaml").read_text("utf-8"))
    return [
        (
            item
            if isinstance(item, str)
            else Row(item["key"], item["does"], item.get("without", {}))
        )
        for item in items
    ]


def snippets(language: str) -> dict[str, str]:
    """Return the code of a program by key, each on one line; code of an inner key is
    omitted.
    """
    lines_by_key: dict[str, list[str]] = {}
    open_keys: list[str] = []
    for line in (FOLDER / PROGRAMS[language]).read_text("utf-8").splitlines():
        mark = _MARK.fullmatch(line)
        if mark is None:
            if open_keys:
                lines_by_key[open_keys[-1]].append(line)
        elif key := mark["key"]:
            if key in lines_by_key:
                raise ValueError(f"{PROGRAMS[language]} has [{key}] twice")
            if open_keys:
                lines_by_key[open_keys[-1]].append("...")
            lines_by_key[key] = []
            open_keys.append(key)
        else:
            open_keys.pop()
    if open_keys:
        raise ValueError(f"[{open_keys[-1]}] of {PROGRAMS[language]} does not end")
    return {
        key: " ".join(line.strip() for line in lines)
        for key, lines in lines_by_key.items()
    }


def page() -> str:
    """Return the text of the page.

    Raises `ValueError` for a row that a program lacks without a reason.
    """
    code = {language: snippets(language) for language in LANGUAGES}
    lines, keys = [BEGIN], set()
    for row in rows():
        if isinstance(row, str):
            lines += [
                f"\n## {row}\n" if keys else f"## {row}\n",
                f"| | {' | '.join(LANGUAGES.values())} |",
                "|---|---|---|---|",
            ]
            continue
        keys.add(row.key)
        cells = [_cell(row, language, code[language]) for language in LANGUAGES]
        lines.append(f"| {row.does} | {' | '.join(cells)} |")
    for language, snippets_of_language in code.items():
        if unknown_keys := snippets_of_language.keys() - keys:
            raise ValueError(
                f"{PROGRAMS[language]} has {sorted(unknown_keys)}, of which rows.yaml knows nothing"
            )
    return "\n".join(lines) + "\n" + END


def _cell(row: Row, language: str, code: dict[str, str]) -> str:
    if (row.key in code) == (language in row.without):
        raise ValueError(
            f"{PROGRAMS[language]} and rows.yaml disagree about [{row.key}]"
        )
    return row.without.get(language) or f"`{code[row.key]}`".replace("|", "\\|")


def main() -> None:
    if not PAGE.exists() or PAGE.read_text("utf-8") != page():
        PAGE.write_text(page(), "utf-8")
        print(f"written: {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()

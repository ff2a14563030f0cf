"""Formatter for ICD files and errata overlays: ``icdgen fmt``.

`format_text` reads a text into a tree with comments (`read`, `commented`), converts
keys of earlier versions (`earlier`, `earlier_buses`) and writes the tree in the
canonical layout (`write`). It then reads the result back and compares it with the
original.
"""

from __future__ import annotations

from collections import Counter

from icdgen.errors import UserError
from icdgen.icd import source
from icdgen.icd.located import Map


def format_text(text: str, name: str) -> str:
    """Return the text of a file in the canonical layout, with its comments.

    Keys of earlier versions are converted to the present ones. ``name`` is the file
    name in findings.

    Raises `diagnostics.Findings` if the loader cannot read the text, because then its
    meaning is unclear.
    """
    from icdgen.icd.fmt import earlier, kinds, read, write

    text = text.removeprefix("\ufeff")
    values = source.parse(text.encode("utf-8", "surrogatepass"), name)
    document = "errata" if "errata" in values else "icd"
    root = read.read_commented(text, values)
    is_converted = earlier.convert(root)
    result = write.write_canonical(root, kinds.kind_of_root(document))
    if is_converted:
        values = source.parse(result.encode("utf-8", "surrogatepass"), name)
    if result != text:
        _verify(text, values, result, name)
    return result


def _verify(text: str, values: Map, result: str, name: str) -> None:
    """Read a formatted text back, and raise `UserError` if values or comments differ
    from the original.
    """
    from icdgen.icd.fmt.read import comments

    formatted = source.parse(result.encode("utf-8"), name)
    if not same(values, formatted) or Counter(comments(text)) != Counter(
        comments(result)
    ):
        raise UserError(
            f"{name}: the formatter would change the meaning of this file",
            "the file is left as it was; this is a defect of icdgen: please report it",
        )


def same(first: object, second: object) -> bool:
    """Return whether two trees are equal, including types (1 is not true).

    The order of keys does not matter.
    """
    if isinstance(first, dict):
        if not isinstance(second, dict) or first.keys() != second.keys():
            return False
        return all(same(value, second[key]) for key, value in first.items())
    if isinstance(first, list):
        return (
            isinstance(second, list)
            and len(first) == len(second)
            and all(map(same, first, second))
        )
    return type(first) is type(second) and first == second

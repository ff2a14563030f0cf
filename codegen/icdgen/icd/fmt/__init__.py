"""The canonical layout of ICD files and errata overlays: ``icdgen fmt``."""

from __future__ import annotations

from collections import Counter

from icdgen.errors import UserError
from icdgen.icd import source
from icdgen.icd.located import Map


def format_text(text: str, name: str) -> str:
    """The file's text in the canonical layout, comments kept. ``name`` is how findings call the file.

    Raises `diagnostics.Findings` for what the loader cannot read; such a text has no one meaning to preserve.
    """
    from icdgen.icd.fmt import kinds, read, write

    text = text.removeprefix("\ufeff")
    values = source.parse(text.encode("utf-8", "surrogatepass"), name)
    document = "errata" if "errata" in values else "icd"
    root = read.read(text, values)
    result = write.write(root, kinds.root(document))
    if result != text:
        _verify(text, values, result, name)
    return result


def _verify(text: str, values: Map, result: str, name: str) -> None:
    """A formatter that loses something is worse than none, so every change is read back."""
    from icdgen.icd.fmt.read import comments

    again = source.parse(result.encode("utf-8"), name)
    if not same(values, again) or Counter(comments(text)) != Counter(comments(result)):
        raise UserError(
            f"{name}: the formatter would change the meaning of this file",
            "the file is left as it was; this is a defect of icdgen: please report it",
        )


def same(one: object, other: object) -> bool:
    """Whether two trees are equal, types included (1 is not true). The order of keys does not matter."""
    if isinstance(one, dict):
        return isinstance(other, dict) and one.keys() == other.keys() and all(same(v, other[k]) for k, v in one.items())
    if isinstance(one, list):
        return isinstance(other, list) and len(one) == len(other) and all(map(same, one, other))
    return type(one) is type(other) and one == other

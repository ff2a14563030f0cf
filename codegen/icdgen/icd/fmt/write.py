"""Tree -> text in the canonical layout, described in ``docs/reference/icd-format.md``."""

from __future__ import annotations

from icdgen.icd.fmt import scalars
from icdgen.icd.fmt.commented import NOTHING, Branch, Child, Text
from icdgen.icd.fmt.kinds import BLOCKS, INLINE, ROWS, Kind
from icdgen.icd.fmt.read import SCHEMA_LINE
from icdgen.icd.fmt.rows import aligned
from icdgen.icd.fmt.scalars import WIDTH

LONGEST_ROW = 160  # of a table whose rows may also be written in block style
MOST_ENTRIES = 6  # of a mapping that the schema does not know and that is written on one line
SHORT_ITEM = 40
LONGEST_KEY = 1000  # YAML readers give up looking for the colon after 1024 characters


def write(root: Branch, kind: Kind) -> str:
    """The text of a whole file."""
    lines = list(root.header)
    if lines and not lines[-1].startswith(SCHEMA_LINE):
        lines.append("")
    if root.children:
        _sections(lines, root, kind)
    else:
        lines.append("{}")
    _comments(lines, root.tail, 0)
    return "\n".join(lines) + "\n"


def _sections(lines: list[str], root: Branch, kind: Kind) -> None:
    """The top level: a blank line before and after each section in block style; the first belongs to the head."""
    sections = after_section = 0
    for child in ordered(root, kind):
        is_section = isinstance(child.value, Branch) and _is_block(child, child.value, kind)
        if sections and (is_section or after_section):
            lines.append("")
        after_section = is_section and sections
        sections += is_section
        _entry(lines, child, kind, 0)


def _is_block(child: Child, value: Branch, kind: Kind) -> bool:
    column = len(scalars.key(child.key, False)) + 2
    inner = kind.child(scalars.name(child.key), value.mapping)
    return _one_line(value, inner, column) is None and _wrapped(value, column) is None


def ordered(branch: Branch, kind: Kind) -> list[Child]:
    """The entries in the order of the schema; those that it does not know come last, as they stood."""
    order = kind.keys
    return sorted(branch.children, key=lambda c: order.get(scalars.name(c.key), len(order)))


def _comments(lines: list[str], comments: list[str], indent: int) -> None:
    lines += [" " * indent + comment if comment else "" for comment in comments]


def _entry(lines: list[str], child: Child, kind: Kind, indent: int) -> None:
    key = scalars.key(child.key, False)
    head = " " * indent + key + ":"
    if len(key) > LONGEST_KEY:
        head = " " * indent + "? " + key + "\n" + " " * indent + ":"
    inner = kind.child(scalars.name(child.key), child.value.mapping) if isinstance(child.value, Branch) else kind
    _value(lines, child, head, inner, indent, in_sequence=False)


def _value(lines: list[str], child: Child, head: str, kind: Kind, indent: int, in_sequence: bool) -> None:
    """An entry or an item with its comments. ``head`` is all of its first line that stands before the value."""
    value = child.value
    column = len(head) - head.rfind("\n")
    trailing = "  " + child.trailing[-1] if child.trailing else ""
    before = [*child.before, *child.trailing[:-1]]
    body: list[str] = []
    if isinstance(value, Text):
        found = scalars.block(value, column, indent + 2)
        at = 0 if found[0] in scalars.BLOCK_HEADERS and len(found) > 1 else -1
        found[at] += trailing
        body = [head + " " + found[0], *found[1:]]
    elif (flow := _one_line(value, kind, column)) is not None:
        before += value.comments()
        body = [head + " " + flow + trailing]
    elif (wrapped := _wrapped(value, column)) is not None:
        body = [head + " " + wrapped[0], *wrapped[1:]]
        body[-1] += trailing
    else:
        inner = _block(value, kind, indent + 2)
        if in_sequence:  # the first entry follows the dash on its line
            while not inner[0] or inner[0].lstrip().startswith("#"):
                before.append(inner.pop(0).strip())
            inner[0] = head + inner[0][indent + 1 :]
            body = inner
            before += child.trailing[-1:]
        else:
            body = [head + trailing, *inner]
    _comments(lines, before, indent)
    lines += body


def _block(branch: Branch, kind: Kind, indent: int) -> list[str]:
    lines: list[str] = []
    if branch.mapping:
        for child in ordered(branch, kind):
            _entry(lines, child, kind, indent)
    else:
        _items(lines, branch, kind, indent)
    _comments(lines, branch.tail, indent)
    return lines


def _items(lines: list[str], branch: Branch, kind: Kind, indent: int) -> None:
    dash = " " * indent + "-"
    rows = _rows(branch, kind, indent)
    if rows is not None:
        for child, row in zip(branch.children, rows, strict=True):
            trailing = "  " + child.trailing[-1] if child.trailing else ""
            inside = child.value.comments() if isinstance(child.value, Branch) else []
            _comments(lines, [*child.before, *child.trailing[:-1], *inside], indent)
            lines.append(f"{dash} {row}{trailing}")
        return
    for number, child in enumerate(branch.children):
        inner = kind.child(None, child.value.mapping) if isinstance(child.value, Branch) else kind
        if number and inner.name in BLOCKS and indent == 2:
            lines.append("")
        _value(lines, child, dash, inner, indent, in_sequence=True)


def _rows(branch: Branch, kind: Kind, indent: int) -> list[str] | None:
    """The aligned rows of a table; None if the sequence is none or its rows are better read in block style."""
    items = [one for one in _branches(branch) if one.mapping and one.children]
    if len(items) < len(branch.children):
        return None
    inner = kind.child(None, True)
    if inner.name in BLOCKS:
        return None
    if inner.name not in ROWS and not all(_simple(item) and not item.commented() for item in items):
        return None
    rows = aligned([_cells(item, inner) for item in items])
    if inner.name not in ROWS and any(indent + 2 + len(row) > LONGEST_ROW for row in rows):
        return None
    return rows


def _simple(branch: Branch) -> bool:
    """Whether its values are scalars or lists of scalars."""
    return not any(one.mapping or _branches(one) for one in _branches(branch))


def _branches(branch: Branch) -> list[Branch]:
    """The mappings and sequences directly in it."""
    return [child.value for child in branch.children if isinstance(child.value, Branch)]


def _one_line(branch: Branch, kind: Kind, column: int) -> str | None:
    """The value in braces or brackets where it should stand on one line, else None."""
    if branch.children:
        if branch.mapping:
            if kind.name in BLOCKS:
                return None
            if kind.name not in ROWS and not (_small(branch, kind) and not branch.commented()):
                return None
        elif branch.commented() or not _inline(branch, kind):
            return None
    text = flow(branch, kind)
    if branch.children and kind.name not in ROWS and column + len(text) > WIDTH:
        return None
    return text


def _small(branch: Branch, kind: Kind) -> bool:
    return _simple(branch) and (bool(kind.name) or len(branch.children) <= MOST_ENTRIES)


def _inline(branch: Branch, kind: Kind) -> bool:
    """Whether a sequence may stand on one line: scalars, lists of scalars, or small mappings of the right kind."""
    can_be_mappings = kind.child(None, True).name in INLINE
    return all(_simple(one) and (can_be_mappings or not one.mapping) for one in _branches(branch))


def _wrapped(branch: Branch, column: int) -> list[str] | None:
    """A list of short scalars over several lines, hanging from its bracket."""
    if branch.mapping or branch.commented() or _branches(branch):
        return None
    items = [scalars.flow(child.value) for child in branch.children if isinstance(child.value, Text)]
    if any(len(item) > SHORT_ITEM for item in items):
        return None
    lines = ["["]
    for index, item in enumerate(items):
        item += "," if index < len(items) - 1 else "]"
        used = len(lines[-1]) + (column if len(lines) == 1 else 0)
        if lines[-1] != "[" and used + 1 + len(item) > WIDTH:
            lines.append(" " * (column + 1) + item)
        else:
            lines[-1] += ("" if lines[-1] == "[" else " ") + item
    return lines


def flow(value: Text | Branch, kind: Kind) -> str:
    """The value on one line."""
    if isinstance(value, Text):
        return scalars.flow(value)
    if value.mapping:
        return "{" + ", ".join(_cells(value, kind).values()) + "}"
    return "[" + ", ".join(flow(c.value, _kind(kind, c)) for c in value.children) + "]"


def _cells(branch: Branch, kind: Kind) -> dict[str, str]:
    """Key -> ``key: value`` in the order of the schema."""
    cells = {}
    for child in ordered(branch, kind):
        key = scalars.key(child.key, True)
        lead = "? " + key + " :" if len(key) > LONGEST_KEY else key + ":"
        cells[scalars.name(child.key)] = f"{lead} {flow(child.value, _kind(kind, child))}"
    return cells


def _kind(kind: Kind, child: Child) -> Kind:
    if isinstance(child.value, Text):
        return kind
    return kind.child(None if child.key is NOTHING else scalars.name(child.key), child.value.mapping)

"""Writer of trees in the canonical layout, which ``docs/reference/icd-format.md``
describes.

For each mapping and list, `write_canonical` chooses between one line, rows of a table,
and block style. `kinds` has the order of keys, `scalars` the spelling of values, and
`rows` aligns tables.
"""

from __future__ import annotations

from icdgen.icd.fmt import scalars
from icdgen.icd.fmt.commented import NOTHING, Branch, Child, ScalarText
from icdgen.icd.fmt.kinds import BLOCKS, INLINE, ROWS, SchemaKind
from icdgen.icd.fmt.read import SCHEMA_LINE
from icdgen.icd.fmt.rows import aligned
from icdgen.icd.fmt.scalars import WIDTH

LONGEST_ROW = 160  # of a table whose rows can also be written in block style
MOST_ENTRIES = 6  # of a mapping on one line that the schema does not define
SHORT_ITEM = 40  # longest item of a list that is wrapped over several lines
LONGEST_KEY = 1000  # YAML readers give up looking for the colon after 1024 characters


def write_canonical(root: Branch, kind: SchemaKind) -> str:
    """Return the text of a file."""
    lines = list(root.header)
    if lines and not lines[-1].startswith(SCHEMA_LINE):
        lines.append("")
    if root.children:
        _sections(lines, root, kind)
    else:
        lines.append("{}")
    _comments(lines, root.tail, 0)
    return "\n".join(lines) + "\n"


def _sections(lines: list[str], root: Branch, kind: SchemaKind) -> None:
    """Append the top level, with a blank line before and after each section in block
    style except the first.
    """
    sections = after_section = 0
    for child in ordered(root, kind):
        is_section = isinstance(child.value, Branch) and _is_block(
            child, child.value, kind
        )
        if sections and (is_section or after_section):
            lines.append("")
        after_section = is_section and sections
        sections += is_section
        _entry(lines, child, kind, 0)


def _is_block(child: Child, value: Branch, kind: SchemaKind) -> bool:
    """Return whether an entry of the top level is written in block style."""
    column = len(scalars.key(child.key, False)) + 2
    inner = kind.child(scalars.name(child.key), value.mapping)
    return _one_line(value, inner, column) is None and _wrapped(value, column) is None


def ordered(branch: Branch, kind: SchemaKind) -> list[Child]:
    """Return the entries in the order of the schema.

    Unknown keys come last, in the order of the file.
    """
    order = kind.keys
    return sorted(
        branch.children,
        key=lambda child: order.get(scalars.name(child.key), len(order)),
    )


def _comments(lines: list[str], comments: list[str], indent: int) -> None:
    """Append comments on lines of their own."""
    lines += [" " * indent + comment if comment else "" for comment in comments]


def _entry(lines: list[str], child: Child, kind: SchemaKind, indent: int) -> None:
    """Append an entry of a mapping in block style."""
    key = scalars.key(child.key, False)
    head = " " * indent + key + ":"
    # A longer key needs the explicit form of YAML.
    if len(key) > LONGEST_KEY:
        head = " " * indent + "? " + key + "\n" + " " * indent + ":"
    inner = (
        kind.child(scalars.name(child.key), child.value.mapping)
        if isinstance(child.value, Branch)
        else kind
    )
    _value(lines, child, head, inner, indent, in_sequence=False)


def _value(
    lines: list[str],
    child: Child,
    head: str,
    kind: SchemaKind,
    indent: int,
    in_sequence: bool,
) -> None:
    """Append an entry or an item with its comments.

    ``head`` is the part of its first line before the value.
    """
    value = child.value
    column = len(head) - head.rfind("\n")
    trailing = "  " + child.trailing[-1] if child.trailing else ""
    before = [*child.before, *child.trailing[:-1]]
    body: list[str] = []
    if isinstance(value, ScalarText):
        scalar = scalars.block(value, column, indent + 2)
        # In the lines of a block scalar, a comment would be text; it can only follow
        # the header.
        at = 0 if scalar[0] in scalars.BLOCK_HEADERS and len(scalar) > 1 else -1
        scalar[at] += trailing
        body = [head + " " + scalar[0], *scalar[1:]]
    elif (flow := _one_line(value, kind, column)) is not None:
        # Comments inside of a value on one line move above it.
        before += value.comments()
        body = [head + " " + flow + trailing]
    elif (wrapped := _wrapped(value, column)) is not None:
        body = [head + " " + wrapped[0], *wrapped[1:]]
        body[-1] += trailing
    else:
        inner = _block(value, kind, indent + 2)
        # In a sequence, the first entry of a mapping is on the line of the dash.
        if in_sequence:
            while not inner[0] or inner[0].lstrip().startswith("#"):
                before.append(inner.pop(0).strip())
            inner[0] = head + inner[0][indent + 1 :]
            body = inner
            before += child.trailing[-1:]
        else:
            body = [head + trailing, *inner]
    _comments(lines, before, indent)
    lines += body


def _block(branch: Branch, kind: SchemaKind, indent: int) -> list[str]:
    """Return the lines of a mapping or sequence in block style."""
    lines: list[str] = []
    if branch.mapping:
        for child in ordered(branch, kind):
            _entry(lines, child, kind, indent)
    else:
        _items(lines, branch, kind, indent)
    _comments(lines, branch.tail, indent)
    return lines


def _items(lines: list[str], branch: Branch, kind: SchemaKind, indent: int) -> None:
    """Append the items of a sequence, as aligned rows of a table if possible."""
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
        inner = (
            kind.child(None, child.value.mapping)
            if isinstance(child.value, Branch)
            else kind
        )
        if number and inner.name in BLOCKS and indent == 2:
            lines.append("")
        _value(lines, child, dash, inner, indent, in_sequence=True)


def _rows(branch: Branch, kind: SchemaKind, indent: int) -> list[str] | None:
    """Return the aligned rows of a table; None if the sequence is not a table, or its
    rows are too long for one line.
    """
    items = [item for item in _branches(branch) if item.mapping and item.children]
    if len(items) < len(branch.children):
        return None
    inner = kind.child(None, True)
    if inner.name in BLOCKS:
        return None
    if inner.name not in ROWS and not all(
        _simple(item) and not item.commented() for item in items
    ):
        return None
    rows = aligned([_cells(item, inner) for item in items])
    if inner.name not in ROWS and any(
        indent + 2 + len(row) > LONGEST_ROW for row in rows
    ):
        return None
    return rows


def _simple(branch: Branch) -> bool:
    """Return whether all values are scalars or lists of scalars."""
    return not any(inner.mapping or _branches(inner) for inner in _branches(branch))


def _branches(branch: Branch) -> list[Branch]:
    """Return the mappings and sequences directly in a branch."""
    return [child.value for child in branch.children if isinstance(child.value, Branch)]


def _one_line(branch: Branch, kind: SchemaKind, column: int) -> str | None:
    """Return a mapping or sequence in flow style if it is to be written on one line,
    else None.
    """
    if branch.children:
        if branch.mapping:
            if kind.name in BLOCKS:
                return None
            is_small = bool(kind.name) or len(branch.children) <= MOST_ENTRIES
            is_row = kind.name in ROWS
            if not is_row and not (
                is_small and _simple(branch) and not branch.commented()
            ):
                return None
        elif branch.commented() or not _inline(branch, kind):
            return None
    text = flow(branch, kind)
    if branch.children and kind.name not in ROWS and column + len(text) > WIDTH:
        return None
    return text


def _inline(branch: Branch, kind: SchemaKind) -> bool:
    """Return whether a sequence can be on one line: of scalars, lists of scalars, or
    mappings of a kind in `INLINE`.
    """
    can_be_mappings = kind.child(None, True).name in INLINE
    return all(
        _simple(item) and (can_be_mappings or not item.mapping)
        for item in _branches(branch)
    )


def _wrapped(branch: Branch, column: int) -> list[str] | None:
    """Return a list of short scalars in flow style, wrapped over several lines; None
    for any other branch.
    """
    if branch.mapping or branch.commented() or _branches(branch):
        return None
    items = [
        scalars.flow(child.value)
        for child in branch.children
        if isinstance(child.value, ScalarText)
    ]
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


def flow(value: ScalarText | Branch, kind: SchemaKind) -> str:
    """Return a value in flow style, on one line."""
    if isinstance(value, ScalarText):
        return scalars.flow(value)
    if value.mapping:
        return "{" + ", ".join(_cells(value, kind).values()) + "}"
    return (
        "["
        + ", ".join(
            flow(child.value, _kind_of_child(kind, child)) for child in value.children
        )
        + "]"
    )


def _cells(branch: Branch, kind: SchemaKind) -> dict[str, str]:
    """Return ``key: value`` in flow style for each key, in the order of the schema."""
    cells = {}
    for child in ordered(branch, kind):
        key = scalars.key(child.key, True)
        lead = "? " + key + " :" if len(key) > LONGEST_KEY else key + ":"
        cells[scalars.name(child.key)] = (
            f"{lead} {flow(child.value, _kind_of_child(kind, child))}"
        )
    return cells


def _kind_of_child(kind: SchemaKind, child: Child) -> SchemaKind:
    """Return the kind of the value of a child of a branch of this kind."""
    if isinstance(child.value, ScalarText):
        return kind
    return kind.child(
        None if child.key is NOTHING else scalars.name(child.key), child.value.mapping
    )

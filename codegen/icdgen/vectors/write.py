"""Writer of vector files: JSON with one vector per line, so that a change of the ICD
changes few lines.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import lru_cache

from icdgen import __version__
from icdgen.icd.frames import FrameField
from icdgen.icd.layout import VariablePart
from icdgen.icd.places import AnyScalar
from icdgen.vectors.make import FORMAT, FrameVector, MessageVectors, NodeVectors
from icdgen.vectors.settings import NEVER
from icdgen.vectors.shared import SharedRow


def vector_file_text(vectors: NodeVectors) -> str:
    """Return the vector file of one node."""
    node = vectors.node
    head = {
        "icdgen_vectors": FORMAT,
        "generator": f"icdgen {__version__}",
        "node": node.name,
        "digest": node.digest[:16],
        "includes": list(node.includes),
    }
    identification = {
        "node_type": node.node_type,
        "interface_version": node.interface_version,
    }
    head |= {key: value for key, value in identification.items() if value is not None}
    parts = [f"{_json(key)}: {_json(value)}" for key, value in head.items()]
    parts.append(f'"never_set": {_json(list(NEVER))}')
    parts.append('"ids": {\n' + ",\n".join(_ids(vectors)) + "\n}")
    if vectors.shared:
        parts.append(_array("shared_ids", list(_shared(vectors.shared))))
    parts.append(_array("enums", list(_enums(vectors))))
    parts.append(
        _array("messages", [_message(message) for message in vectors.messages])
    )
    return "{\n" + ",\n".join(parts) + "\n}\n"


def decimal(value: Fraction) -> str:
    """Return the number as an exact decimal such as ``-12.34``; ``1/3`` for an infinite
    decimal.
    """
    top, bottom = value.numerator, value.denominator
    digits = _digits(bottom)
    if digits is None:
        return f"{top}/{bottom}"
    integer, part = divmod(abs(top) * 10**digits // bottom, 10**digits)
    sign = "-" if top < 0 else ""
    return f"{sign}{integer}.{part:0{digits}}" if digits else f"{sign}{integer}"


@lru_cache(maxsize=1 << 12)
def _digits(denominator: int) -> int | None:
    """Return the number of decimal digits of a fraction with this denominator; None if
    it is infinite.
    """
    # A finite decimal has at most as many digits as the denominator has factors of 2
    # and 5.
    for digits in range(denominator.bit_length() + 1):
        if not 10**digits % denominator:
            return digits
    return None


def raw_json(field: AnyScalar, value: int | bytes | None) -> int | str | None:
    """Return a raw value in the format of vectors and conformance tests.

    Conformance tests use true and false for booleans.
    """
    if isinstance(value, bytes):
        return value.hex()
    # JSON represents neither NaN nor infinity (RFC 8259, section 6), so that floats are
    # given by their bits.
    if value is not None and field.type == "float":
        return f"{value:0{field.bits // 4}x}"
    return value


def _ids(vectors: NodeVectors) -> Iterator[str]:
    for direction, messages in vectors.ids.items():
        named = {
            str(id): names[0] if len(names) == 1 else names
            for id, names in messages.items()
        }
        yield f"{_json(direction)}: {_json(named)}"


def _shared(rows: Iterable[SharedRow]) -> Iterator[str]:
    for row in rows:
        line = {
            "direction": row.direction,
            "id": row.id,
            "bytes": row.frame.hex(),
            "message": row.message,
        }
        yield _json(
            line if row.expected is None else {**line, "expected": row.expected}
        )


def _enums(vectors: NodeVectors) -> Iterator[str]:
    for enum, unknown in vectors.enums:
        members = [
            [m.value, m.name, *([] if m.to is None else [m.to])] for m in enum.members
        ]
        yield _json({"name": enum.name, "members": members, "unknown": unknown})


def _message(vectors: MessageVectors) -> str:
    message = vectors.message
    head: dict[str, object] = {"name": message.name, "kind": message.kind}
    ids = {"id": message.id, "set_id": message.set_id, "get_id": message.get_id}
    head.update((key, id) for key, id in ids.items() if id is not None)
    head["length"] = message.length
    if message.may_end_early:
        head["may_end_early"] = message.may_end_early
    # Keys of the vector format keep their names: `tail` is the last variable part,
    # `view` an overlay.
    if message.layout.parts:
        *inner, last = message.layout.parts
        behind = {"behind": last.behind} if last.behind else {}
        head["tail"] = _variable_part(last, {"least": last.begin, **behind})
        if inner:
            head["inner"] = [
                _variable_part(part, {"begin": part.begin}) for part in inner
            ]
    # Without its braces: the other parts follow in lines of their own.
    parts = [_json(head)[1:-1]]
    parts.append(_array("fields", [_field(vectors, field) for field in vectors.fields]))
    parts.append(f'"refused_lengths": {_json(list(vectors.refused_lengths))}')
    if vectors.refused_frames:
        parts.append(
            f'"refused_frames": {_json([frame.hex() for frame in vectors.refused_frames])}'
        )
    parts.append(_array("vectors", [_row(vectors.fields, row) for row in vectors.rows]))
    return "{" + ",\n".join(parts) + "}"


def _variable_part(part: VariablePart, begin: dict[str, int]) -> dict[str, object]:
    row = {
        "part": part.name,
        "counter": part.counter,
        **begin,
        "step": part.step,
        "most": part.most,
    }
    row |= {"plus": part.plus} if part.plus else {}
    nested = [_variable_part(inner, {"begin": inner.begin}) for inner in part.inner]
    return row | ({"nested": nested} if nested else {})


def _field(vectors: MessageVectors, field: FrameField) -> str:
    row: dict[str, object] = {
        "name": field.name,
        "type": field.type,
        "bits": field.bits,
    }
    if field.enum is not None:
        row["enum"] = field.enum.name
    if field.scale is not None:
        row["factor"], row["offset"] = str(field.scale.factor), str(field.scale.offset)
    if field.curve is not None:
        row |= field.curve.plain
    if field.role in ("overlay", "derived"):
        row["view"] = True
    if field.role == "derived":
        row["derived"] = field.scalar.formula
    if field.conditions:
        row["when"] = {
            condition.field: list(condition.values) for condition in field.conditions
        }
    row["default"] = raw_json(field, vectors.default.get(field.name))
    if field.special:
        row["special"] = [raw_json(field, special.value) for special in field.special]
    if field.limits:
        limits = {
            key: getattr(field.limits, key) for key in ("min", "max", "above", "below")
        }
        row["limits"] = {
            key: decimal(value) for key, value in limits.items() if value is not None
        }
    if field.name in vectors.refused_raws:
        row["unfit"] = vectors.refused_raws[field.name]
    if field.name in vectors.assignments:
        row["set"] = [
            [given, raw_json(field, raw)]
            for given, raw in vectors.assignments[field.name]
        ]
    return _json(row)


def _row(fields: tuple[FrameField, ...], row: FrameVector) -> str:
    line: dict[str, object] = {"why": row.why, "bytes": row.frame.hex()}
    if row.encoded != row.frame:
        line["encoded"] = row.encoded.hex()
    line["raw"] = [raw_json(field, row.raw.get(field.name)) for field in fields]
    if any(field.scale is not None for field in fields):
        scaled = (field.name for field in fields if field.scale is not None)
        line["physical"] = [
            decimal(row.physical[name]) if name in row.physical else None
            for name in scaled
        ]
    if any(field.has_formula for field in fields):
        line["doubles"] = [
            row.doubles.get(field.name) for field in fields if field.has_formula
        ]
    if row.texts:
        line["texts"] = list(row.texts.values())
    return _json(line)


def _array(name: str, items: list[str]) -> str:
    return f'"{name}": [\n' + ",\n".join(items) + "\n]" if items else f'"{name}": []'


def _json(value: object) -> str:
    return json.dumps(value, separators=(",", ":"))

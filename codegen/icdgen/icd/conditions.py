"""Optional fields.

The key `when` names other fields and the values that they have if the field is present.
`conditions_of` makes the conditions of the model. `faults_of_names` and
`faults_of_values` yield what the rules in `icdgen.icd.rules.conditional` report.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from icdgen.icd.enumeration import Enum
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Condition, LayoutNode, integer_range
from icdgen.icd.located import Map, unread
from icdgen.icd.roles import CONDITION, INTEGERS, reasons_against
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import mappings

_REQUIREMENT = "`when` names a field that every frame has: an integer without a formula, an enumeration value, or a flag"
_TYPES = (*INTEGERS, "float", "bytes", "text")


def _when(item: Map) -> Map:
    """Return the key `when` of a field; empty if it is not a mapping."""
    when = item.get("when")
    return when if isinstance(when, Map) else unread()


def conditions_of(
    fields: Mapping[str, Map], item: Map, enums: Mapping[str, Enum]
) -> tuple[Condition, ...]:
    """Return the valid conditions of a field.

    ``fields`` is the result of `fields_by_name`.
    """
    conditions = []
    for name, listed in _when(item).items():
        field = fields.get(name)
        if field is None or not _can_decide(field):
            continue
        values = [_raw_value(field, value, enums) for value in _as_list(listed)]
        if values and None not in values:
            conditions.append(
                Condition(
                    name,
                    tuple(
                        dict.fromkeys(value for value in values if value is not None)
                    ),
                )
            )
    return tuple(conditions)


def are_valid(node: LayoutNode) -> bool:
    """Return whether all conditions of a node are valid.

    Each invalid condition has a finding. Further rules skip such a node, to avoid
    findings that only follow from it.
    """
    return len(_when(node.source)) == len(node.present_if)


def faults_of_names(
    message: Map, fields: Mapping[str, Map], item: Map
) -> Iterator[Fault]:
    """Yield a fault for each condition that names an absent or unsuitable field.

    ``fields`` is the result of `fields_by_name`.
    """
    when = _when(item)
    for name in when:
        if name not in fields:
            text = f"`{item['name']}` depends on `{name}`, but the message `{message['name']}` has no such field"
            names = (
                other
                for other, field in fields.items()
                if field is not item and _can_decide(field)
            )
            yield Fault.at_key(when, name, text, *suggestion(name, names, _REQUIREMENT))
        elif not _is_sound(fields[name]):
            continue  # another rule reports the type or the width
        elif name == item["name"]:
            yield Fault.at_key(
                when, name, f"`{name}` cannot depend on itself", _REQUIREMENT
            )
        elif reasons := reasons_against(fields[name], CONDITION):
            yield Fault.at_key(
                when,
                name,
                f"`{item['name']}` cannot depend on `{name}`: it {reasons[0]}",
                _REQUIREMENT,
            )


def faults_of_values(
    fields: Mapping[str, Map], item: Map, enums: Mapping[str, Enum]
) -> Iterator[Fault]:
    """Yield the faults of the values in the conditions of a field.

    ``fields`` is the result of `fields_by_name`.
    """
    when = _when(item)
    for name, listed in when.items():
        field = fields.get(name)
        if (
            field is None
            or not _can_decide(field)
            or (field["type"] == "enum" and field.get("enum", "") not in enums)
        ):
            continue  # `faults_of_names` or another rule reports it
        values = _as_list(listed)
        is_constant_listed = "const" in field and field["const"] in (
            _raw_value(field, value, enums) for value in values
        )
        raws: list[int] = []
        for value in values:
            raw = _raw_value(field, value, enums)
            if raw is not None:
                raws.append(raw)
            if raw is None and _is_range(field, value, enums):
                text = f"{_shown(value)} is a range of values of `{field['enum']}`"
                yield Fault.at_key(when, name, text, "list the values as numbers")
            elif raw is None:
                help = f"`{name}` {_possible_values(field, enums)}"
                help += (
                    ", never a text"
                    if isinstance(value, str) and field["type"] != "enum"
                    else ""
                )
                yield Fault.at_key(
                    when, name, f"`{name}` is never {_shown(value)}", help
                )
            elif "const" in field and raw != field["const"]:
                text = f"`{name}` is always {field['const']}, so `{item['name']}` is never present"
                help = "correct the value, or remove the field"
                if is_constant_listed:
                    text = f"`{name}` is never {_shown(value)}, but always {field['const']}"
                    help = "remove the value"
                yield Fault.at_key(when, name, text, help)
        if len(set(raws)) < len(raws):
            yield Fault.at_key(
                when, name, f"a value of `{name}` is given twice", "remove one of them"
            )


def _as_list(value: object) -> list[object]:
    """Return a list of values; a single value as a list of one element."""
    return list(value) if isinstance(value, list) else [value]


def _shown(value: object) -> str:
    """Return a value in the syntax of an ICD; text in backticks."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"`{value}`" if isinstance(value, str) else str(value)


def _raw_value(field: Map, value: object, enums: Mapping[str, Enum]) -> int | None:
    """Return the raw value of a value in an ICD; None if the field cannot have it."""
    kind, bits = field["type"], field["bits"]
    if kind == "enum":
        enum = enums.get(field.get("enum", ""))
        if isinstance(value, str):
            for member in enum.members if enum else ():
                if member.name == value and member.to is None:
                    return member.value
            return None
        if type(value) is not int:
            return None
        low, high = integer_range(bits, enum is not None and enum.signed)
        return value if low <= value <= high else None
    # In YAML a flag is true, false, 0 or 1, and in Python True is an int.
    if kind == "bool":
        return int(value) if value in (0, 1) and isinstance(value, int) else None
    low, high = integer_range(bits, kind == "int")
    return value if type(value) is int and low <= value <= high else None


def _is_range(field: Map, value: object, enums: Mapping[str, Enum]) -> bool:
    """Return whether a value is the name of a member that stands for a range of values."""
    enum = enums.get(field.get("enum", ""))
    return enum is not None and any(
        member.name == value and member.to is not None for member in enum.members
    )


def _possible_values(field: Map, enums: Mapping[str, Enum]) -> str:
    """Return which values a field has, as the end of a sentence."""
    if field["type"] == "bool":
        return "is true or false"
    if field["type"] == "enum":
        enum = enums.get(field.get("enum", ""))
        names = (
            ", ".join(f"`{member.name}`" for member in enum.members[:5])
            if enum
            else "nothing"
        )
        return f"has a value of `{field.get('enum')}`: {names}{' ...' if enum and len(enum.members) > 5 else ''}"
    low, high = integer_range(field["bits"], field["type"] == "int")
    return f"is {low:,} to {high:,}"


def _can_decide(field: Map) -> bool:
    """Return whether other fields can depend on a field."""
    return _is_sound(field) and not reasons_against(field, CONDITION)


def _is_sound(field: Map) -> bool:
    """Return whether type, width and enumeration of a field are valid."""
    kind, bits = field.get("type"), field.get("bits", 1 if "size" in field else 0)
    if (
        kind not in _TYPES
        or type(bits) is not int
        or not isinstance(field.get("enum", ""), str)
    ):
        return False
    return 0 < bits <= 64 or (bits > 64 and kind not in INTEGERS)


def fields_by_name(message: Map) -> dict[str, Map]:
    """Return the fields of a message by name, without structs.

    If a name occurs twice, the first field is used.
    """
    named = [
        item
        for item in mappings(message.get("fields"))
        if isinstance(item.get("name"), str)
    ]
    return {item["name"]: item for item in reversed(named) if "struct" not in item}


def are_exclusive(first: tuple[Condition, ...], second: tuple[Condition, ...]) -> bool:
    """Return whether two fields with these conditions are never present in the same
    frame.
    """
    for condition in first:
        for other in second:
            values = set(condition.values)
            if condition.field == other.field and values.isdisjoint(other.values):
                return True
    return False

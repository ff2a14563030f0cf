"""Fields that are not always there: `when` of a field names others and the values that they must have then."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from icdgen.icd.enumeration import Enum
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Condition, LayoutNode
from icdgen.icd.located import Map, unread
from icdgen.icd.roles import CONDITION, INTEGERS, reasons_against
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import mappings

_LEAST = "`when` names a field that every frame has: an integer without a formula, an enumeration value, or a flag"
_TYPES = (*INTEGERS, "float", "bytes", "text")


def _given(item: Map) -> Map:
    """What a field says under `when`; nothing where that is no mapping."""
    found = item.get("when")
    return found if isinstance(found, Map) else unread()


def of(message: Map, item: Map, enums: Mapping[str, Enum]) -> tuple[Condition, ...]:
    """The conditions of a field; of what is wrong with one, nothing."""
    known = _fields(message)
    found = []
    for name, said in _given(item).items():
        one = known.get(name)
        if one is None or not _decides(one):
            continue
        values = [_value(one, each, enums) for each in _listed(said)]
        if values and None not in values:
            found.append(Condition(name, tuple(dict.fromkeys(value for value in values if value is not None))))
    return tuple(found)


def are_understood(node: LayoutNode) -> bool:
    """Return whether a node has all conditions of its line. Each that is wrong has a finding, and no other follows from it."""
    return len(_given(node.source)) == len(node.present_if)


def faults_of_names(message: Map, item: Map) -> Iterator[Fault]:
    """What is wrong with the fields that it depends on."""
    when, known = _given(item), _fields(message)
    for name in when:
        if name not in known:
            text = f"`{item['name']}` depends on `{name}`, but `{message['name']}` has no such field"
            names = (other for other, one in known.items() if one is not item and _decides(one))
            yield Fault.at_key(when, name, text, *suggestion(name, names, _LEAST))
        elif not _is_sound(known[name]):
            continue  # a finding already
        elif name == item["name"]:
            yield Fault.at_key(when, name, f"`{name}` cannot depend on itself", _LEAST)
        elif reasons := reasons_against(known[name], CONDITION):
            yield Fault.at_key(when, name, f"`{item['name']}` cannot depend on `{name}`: it {reasons[0]}", _LEAST)


def faults_of_values(message: Map, item: Map, enums: Mapping[str, Enum]) -> Iterator[Fault]:
    """What is wrong with the values that others must have."""
    when, known = _given(item), _fields(message)
    for name, listed in when.items():
        one = known.get(name)
        if one is None or not _decides(one) or (one["type"] == "enum" and one.get("enum", "") not in enums):
            continue  # a finding already
        values = [_value(one, said, enums) for said in _listed(listed)]
        for said, value in zip(_listed(listed), values, strict=True):
            if value is None and _is_range(one, said, enums):
                text = f"{_shown(said)} is a range of values of `{one['enum']}`"
                yield Fault.at_key(when, name, text, "list the values as numbers")
            elif value is None:
                yield Fault.at_key(when, name, f"`{name}` is never {_shown(said)}", f"`{name}` {_allowed(one, enums)}")
            elif "const" in one and value != one["const"]:
                text = f"`{name}` is always {one['const']}, so `{item['name']}` is never present"
                yield Fault.at_key(when, name, text, "correct the value, or remove the field")
        told = [value for value in values if value is not None]
        if len(set(told)) < len(told):
            yield Fault.at_key(when, name, f"a value of `{name}` is given twice", "remove one of them")


def _listed(said: object) -> list[object]:
    return list(said) if isinstance(said, list) else [said]


def _shown(said: object) -> str:
    return str(said).lower() if isinstance(said, bool) else f"`{said}`" if isinstance(said, str) else str(said)


def _value(field: Map, said: object, enums: Mapping[str, Enum]) -> int | None:
    """The raw value that is meant; None if the field cannot have it."""
    kind, bits = field["type"], field["bits"]
    if kind == "enum":
        enum = enums.get(field.get("enum", ""))
        if isinstance(said, str):
            members = enum.members if enum else ()
            return next((one.value for one in members if one.name == said and one.to is None), None)
        if type(said) is not int:
            return None
        low, high = _range(bits, enum is not None and enum.signed)
        return said if low <= said <= high else None
    if kind == "bool":
        return int(said) if said in (0, 1) and isinstance(said, int) else None
    low, high = _range(bits, kind == "int")
    return said if type(said) is int and low <= said <= high else None


def _range(bits: int, is_signed: bool) -> tuple[int, int]:
    """The least and the largest raw value."""
    return (-(1 << bits - 1), (1 << bits - 1) - 1) if is_signed else (0, (1 << bits) - 1)


def _is_range(field: Map, said: object, enums: Mapping[str, Enum]) -> bool:
    enum = enums.get(field.get("enum", ""))
    return enum is not None and any(one.name == said and one.to is not None for one in enum.members)


def _allowed(field: Map, enums: Mapping[str, Enum]) -> str:
    if field["type"] == "bool":
        return "is true or false"
    if field["type"] == "enum":
        enum = enums.get(field.get("enum", ""))
        names = ", ".join(f"`{one.name}`" for one in enum.members[:5]) if enum else "nothing"
        return f"has a value of `{field.get('enum')}`: {names}{' ...' if enum and len(enum.members) > 5 else ''}"
    low, high = _range(field["bits"], field["type"] == "int")
    return f"is {low:,} to {high:,}"


def _decides(field: Map) -> bool:
    """Whether something can depend on a field."""
    return _is_sound(field) and not reasons_against(field, CONDITION)


def _is_sound(field: Map) -> bool:
    """Whether there is no finding already of what is looked at here."""
    kind, bits = field.get("type"), field.get("bits", 1 if "size" in field else 0)
    if kind not in _TYPES or type(bits) is not int or not isinstance(field.get("enum", ""), str):
        return False
    return 0 < bits <= 64 or (bits > 64 and kind not in INTEGERS)


def _fields(message: Map) -> dict[str, Map]:
    """The fields by name, but for structs."""
    found = [item for item in mappings(message.get("fields")) if isinstance(item.get("name"), str)]
    return {item["name"]: item for item in reversed(found) if "struct" not in item}


def exclude(one: tuple[Condition, ...], other: tuple[Condition, ...]) -> bool:
    """Whether two fields of these conditions are never both there."""
    return any(a.field == b.field and not set(a.values) & set(b.values) for a in one for b in other)

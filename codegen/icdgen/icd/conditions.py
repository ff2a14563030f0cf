"""Fields that are not always there: `when` of a field names others and the values that they must have then."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import Condition, Enum, Field
from icdgen.suggest import close_to

_LEAST = "`when` names a field that is always there: an unsigned number without a formula, a value of an enumeration, or a flag"
_PLAIN = ("uint", "enum", "bool")
_TYPES = (*_PLAIN, "int", "float", "bytes", "text")


def given(item: Map) -> Map | None:
    """What a field says under `when`; None where that is nothing, or no mapping."""
    found = item.get("when")
    return found if isinstance(found, Map) else None


def of(message: Map, item: Map, enums: Mapping[str, Enum]) -> tuple[Condition, ...]:
    """The conditions of a field; of what is wrong with one, nothing."""
    when = given(item)
    if when is None:
        return ()
    known = _fields(message)
    found = []
    for name in when:
        one = known.get(name)
        values = (
            []
            if one is None or not _is_sound(one) or _odd(one)
            else [_value(one, said, enums) for said in _listed(when[name])]
        )
        if values and None not in values:
            found.append(Condition(name, tuple(dict.fromkeys(value for value in values if value is not None))))
    return tuple(found)


def are_understood(field: Field) -> bool:
    """Whether a field has all the conditions that it is given: what is wrong with one is a finding, and no more follows."""
    when = given(field.source)
    return when is None or len(when) == len(field.when)


def faults_of_names(message: Map, item: Map) -> Iterator[Fault]:
    """What is wrong with the fields that it depends on."""
    when, known = given(item), _fields(message)
    for name in when or ():
        assert when is not None
        if name not in known:
            text = f"`{name}`, on which `{item['name']}` depends, is no field of `{message['name']}`"
            yield Fault.at_key(when, name, text, _meant(name, item, known) or _LEAST)
        elif not _is_sound(known[name]):
            continue  # a finding already
        elif why := "is the field itself" if name == item["name"] else _odd(known[name]):
            yield Fault.at_key(when, name, f"`{name}`, on which `{item['name']}` depends, {why}", _LEAST)


def _meant(name: str, item: Map, known: Mapping[str, Map]) -> str:
    """The question whether another field is meant, of those that ``item`` can depend on; empty if none comes near."""
    near = close_to(
        name, (other for other, one in known.items() if one is not item and _is_sound(one) and not _odd(one))
    )
    return f"did you mean `{near}`?" if near else ""


def faults_of_values(message: Map, item: Map, enums: Mapping[str, Enum]) -> Iterator[Fault]:
    """What is wrong with the values that others must have."""
    when, known = given(item), _fields(message)
    for name in when or ():
        assert when is not None
        one = known.get(name)
        if (
            one is None
            or not _is_sound(one)
            or _odd(one)
            or (one["type"] == "enum" and one.get("enum", "") not in enums)
        ):
            continue  # a finding already
        values = [_value(one, said, enums) for said in _listed(when[name])]
        for said, value in zip(_listed(when[name]), values, strict=True):
            if value is None and _is_range(one, said, enums):
                text = f"{_shown(said)} is a range of values of `{one['enum']}`"
                yield Fault.at_key(when, name, text, "write the values as numbers, each that is meant")
            elif value is None:
                yield Fault.at_key(when, name, f"`{name}` is never {_shown(said)}", f"`{name}` {_allowed(one, enums)}")
            elif "const" in one and value != one["const"]:
                text = f"`{name}` is always {one['const']}, so that `{item['name']}` is never there"
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
            return (
                next((one.value for one in enum.members if one.name == said and one.to is None), None) if enum else None
            )
        if type(said) is not int:
            return None
        low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if enum and enum.signed else (0, (1 << bits) - 1)
        return said if low <= said <= high else None
    if kind == "bool":
        return int(said) if said in (0, 1) and isinstance(said, int) else None
    return said if type(said) is int and 0 <= said < 1 << bits else None


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
    return f"is 0 to {(1 << field['bits']) - 1:,}"


def _odd(field: Map) -> str:
    """Why nothing can depend on a field, as the end of a sentence; empty if something can."""
    if "when" in field:
        return "is not always there itself"
    for key, words in (
        ("count", "is an array"),
        ("size", "is open"),
        ("bitfields", "is divided"),
        ("formula", "is scaled"),
        ("points", "is scaled"),
    ):
        if key in field:
            return words
    if field.get("view"):
        return "is a view"
    return "" if field.get("type") in _PLAIN else f"is `{field.get('type')}`"


def _is_sound(field: Map) -> bool:
    """Whether there is no finding already of what is looked at here."""
    kind, bits = field.get("type"), field.get("bits", 1 if "size" in field else 0)
    if kind not in _TYPES or type(bits) is not int or not isinstance(field.get("enum", ""), str):
        return False
    return 0 < bits <= 64 or (bits > 64 and kind not in _PLAIN)


def _fields(message: Map) -> dict[str, Map]:
    """The fields by name, but for structs."""
    items = message.get("fields")
    found = [item for item in items if isinstance(item, Map)] if isinstance(items, list) else []
    return {
        item["name"]: item for item in reversed(found) if isinstance(item.get("name"), str) and "struct" not in item
    }


def exclude(one: tuple[Condition, ...], other: tuple[Condition, ...]) -> bool:
    """Whether two fields of these conditions are never both there."""
    return any(a.field == b.field and not set(a.values) & set(b.values) for a in one for b in other)

"""The statements of a message's decode function."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from icdgen.backends.c import bits
from icdgen.backends.c.names import stem
from icdgen.backends.c.statement import call, either, failed_length_test, loop
from icdgen.backends.c.text import WIDTH
from icdgen.backends.c.types import cast, type_of
from icdgen.backends.lines import STEP
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.arrays import ElementRounds, StructArray
from icdgen.describe.description import Composite, VariablePartDescription
from icdgen.describe.groups import Flags, Group, Rounds, Row, Thresholds
from icdgen.describe.lengths import length_tests

THRESHOLDS = Thresholds(flags=(8, 4), row=8)
"""Groups for which the support header has macros."""

EMPTY = "empty"
"""Member of the struct of a message without fields: C has no empty structs."""


class Structs(NamedTuple):
    """An array of structs, which a loop reads and writes."""

    array: StructArray
    reading: str  # the function for an element
    writing: str

    @property
    def length(self) -> int:
        """Bytes of the frame."""
        return self.array.field.count * self.array.step


Groups = list[Group | Structs]


def members_of_round(group: Rounds) -> tuple[FieldDescription, ...]:
    """The elements of a round; ``element`` is the first of them in the array."""
    name = group.array.member
    return group.rounds.members(group.first, lambda element: f"{name}[element{f' + {element}u' if element else ''}]")


def macro_of(group: Flags | Row) -> str:
    """How the name of the macro for a group ends."""
    if isinstance(group, Row):
        return f"ROW_{group.fields[0].order.upper()}"
    return f"{len(group.fields)}_FLAGS{'_FALLING' if group.is_falling else ''}"


def statements(message: Composite[Any], groups: Groups) -> list[str]:
    """One statement a field or a group, in the order of the groups."""
    if not message.members:
        return ["(void)buffer;", f"message->{EMPTY} = 0u;"]
    found = [_one(one) if isinstance(one, FieldDescription) else _group(one, message) for one in groups]
    if message.last_part is not None and message.last_part.counter.model.is_count:
        counter = message.last_part.counter
        found.append(f"message->{counter.name} = {cast(_count(message.last_part), counter.storage.bits)};")
    return found


def _count(part: VariablePartDescription) -> str:
    """How many elements there are in ``length`` bytes, without the fewest that there can be."""
    rest = f"length - {part.model.shortest}u" if part.model.shortest else "length"
    if part.model.step == 1:
        return rest
    return f"({rest}) / {part.model.step}u" if part.model.shortest else f"{rest} / {part.model.step}u"


def misfit_length(part: VariablePartDescription, longest: str, known: int = 0) -> str:
    """What holds of a ``length`` of ``known`` bytes or more that no frame has; ``longest`` is the macro of the longest."""
    return either([failed_length_test(test, longest) for test in length_tests(part.model.lengths, known)])


def miscounted(part: VariablePartDescription) -> tuple[str, str, str] | None:
    """Type and reading of the count that a frame holds, as ``value``, and what holds where it is not that of its length."""
    if part.counter.model.is_count:
        return None
    bits = max(part.counter.storage.bits, 32)
    value = "value" if part.counter.storage.bits == bits else cast("value", bits)
    told = cast(_count(part), bits) + (f" + {part.model.low}u" if part.model.low else "")
    return type_of(part.counter), number(part.counter, "value"), f"{value} != {told}"


def of_inner(message: MessageDescription) -> list[dict[str, object]]:
    """How the open parts in front of the part are found in a frame, whose fixed part is in ``buffer``, and put into one."""
    return [
        {
            "type": type_of(one.counter),
            "reading": number(one.counter, "value"),
            "misfit": miscount(one, "value") if one.needs_count_check else "",
            "begin": one.model.begin,
            "there": _bytes(elements(one, "value"), one.model.step),
            "given": _bytes(elements(one), one.model.step),
            "miscount": miscount(one) if one.needs_count_check else "",
            "counter": one.counter,
        }
        for one in message.earlier_parts
    ]


def _bytes(count: str, step: int) -> str:
    return count if step == 1 else f"{count} * {step}u"


def of_elements(part: VariablePartDescription, reading: str) -> list[str]:
    """The statements that read the structs of an open end, each where it stands in ``buffer``."""
    name = part.field.member
    loop_over = for_each(name, there(part), reading, part.model.begin, part.model.step)
    return [f"(void)memset(message->{name}, 0, sizeof message->{name});", loop_over]


def for_each(name: str, count: str, function: str, begin: int, step: int) -> str:
    """The loop that calls a function for each element of an array of structs, and where it stands in ``buffer``."""
    if count == "1u":
        return call(function, (f"&message->{name}[0]", f"&buffer[{begin}]"))
    made = call(function, (f"&message->{name}[element]", f"&buffer[{place(begin, step)}]"), depth=2)
    return f"{loop('element', count)}\n{STEP * 2}{made}\n{STEP}}}"


def of_array(array: StructArray, function: str) -> str:
    """The same for all of an array."""
    return for_each(array.field.member, f"{array.field.count}u", function, array.begin, array.step)


def there(part: VariablePartDescription) -> str:
    """How many elements a frame of ``length`` bytes has."""
    count = _count(part)
    count = f"({count})" if " " in count else count
    return count + (f" + {part.model.fewest}u" if part.model.fewest else "")


def place(begin: int, step: int, in_round: int = 1) -> str:
    """The byte at which ``element`` begins, or the round of so many of them that begins with it."""
    number = "element" if in_round == 1 else f"(element / {in_round}u)"
    offset = number if step == 1 else f"{number} * {step}u"
    return f"{begin}u + {f'({offset})' if step > 1 else offset}" if begin else offset


def elements(part: VariablePartDescription, counter: str = "") -> str:
    """How many elements a message has."""
    count = f"ICDGEN_SIZE({counter or f'message->{part.counter.name}'})"
    if not part.model.plus:
        return count
    return f"({count} {'+' if part.model.fewest else '-'} {abs(part.model.plus)}u)"


def miscount(part: VariablePartDescription, counter: str = "") -> str:
    """What holds of a message whose count is none that it can have."""
    count = counter or f"message->{part.counter.name}"
    tests = [f"{count} < {part.model.low}u"] if part.model.low else []
    tests += [f"{count} > {part.model.high}u"] if part.counter.storage.max > part.model.high else []
    return either(tests)


def in_rounds(rounds: ElementRounds, const: str, lines: Iterable[str]) -> str:
    """The loop around lines for one round, whose bytes ``part`` points to; ``const`` if they are only read."""
    pointer = f"{const}uint8_t *const part = &buffer[{place(rounds.begin, rounds.step, rounds.in_round)}];"
    body = "".join(f"{STEP * 2}{line}\n".replace(f"\n{STEP}", f"\n{STEP * 2}") for line in (pointer, *lines))
    return f"{loop('element', f'{rounds.elements}u', rounds.in_round)}\n{body}{STEP}}}"


def _group(group: Flags | Row | Rounds | Structs, message: Composite[Any]) -> str:
    if isinstance(group, Rounds):
        lines = (number(one, f"message->{one.member}", "part") for one in members_of_round(group))
        return in_rounds(group.rounds, "const ", lines)
    if isinstance(group, Structs):
        return of_array(group.array, group.reading)
    members = [field.member for field in group.fields]
    target = f"{stem(message)}_t", "message"
    if isinstance(group, Flags):
        value = f"buffer[{group.byte}]" + (f" >> {group.shift}" if group.shift else "")
        return call(f"ICDGEN_READ_{macro_of(group)}", (*target, value, *members))
    value = f"&buffer[{group.byte}]"
    return call(f"ICDGEN_READ_{macro_of(group)}", (*target, value, f"{len(members)}u", members[0], members[-1]))


def _one(field: FieldDescription) -> str:
    one = field.model
    if one.is_bytes:
        return f"(void)memcpy(message->{field.member}, &buffer[{one.at // 8}], {one.width // 8}u);"
    return number(field, f"message->{field.member}")


def number(field: FieldDescription, target: str, frame: str = "buffer") -> str:
    """The statement that reads a number from the bytes that ``frame`` points to."""
    read = bits.read(field, frame)
    line = _assigned(field, target, read.whole)
    if len(STEP) + len(line) <= WIDTH or len(read.terms) == 1:
        return line
    within = "" if frame == "buffer" else f"{frame}_"  # in a loop it hides none that stands before it
    local = f"{within}bits_{field.model.at}"
    first, *others = read.terms
    joined = [f"uint{read.bits}_t {local} = {first};", *(f"{local} |= {term};" for term in others)]
    return f"\n{STEP}".join([*joined, _assigned(field, target, read.value.format(bits=local))])


def _assigned(field: FieldDescription, target: str, value: str) -> str:
    if field.model.type == "float":
        return call(f"icdgen_set_f{field.model.bits}", (f"&{target}", value))
    return f"{target} = {value};"

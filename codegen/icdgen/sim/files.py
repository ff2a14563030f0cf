"""Files of the simulated device that the user gives, and programs that it stores.

`read_file` reads a file of the option ``--file``; `saver` writes uploaded objects to a
folder.
"""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

from icdgen_runtime._errors import IcdError
from icdgen_runtime.wire.times import dos_time_pack

from icdgen.errors import UserError, unreadable
from icdgen.icd.model import Icd, Node
from icdgen.procedures.effects import Key, Object, effect_of
from icdgen.procedures.run import steps_of
from icdgen.protocol import facts
from icdgen.protocol.procedures import Procedure, Send, Value
from icdgen.runtime_objects.links import link_of_node
from icdgen.sim.values import number_places
from icdgen.values.entry import parse_physical


def read_file(icd: Icd, node: Node, text: str) -> tuple[str, Key, Object]:
    """Return kind, key and content of a file from a text ``TYPE:COUNTER=PATH``, with the
    inputs of the procedure that reads a file.

    Raise `icdgen.errors.UserError`.
    """
    node_facts = facts.of(icd, node)
    reading = [p for p in node_facts.procedures if effect_of(p).verb == "read"]
    if not reading:
        raise UserError("the ICD describes no files", "leave --file out")
    procedure = reading[0]
    effect = effect_of(procedure)
    numbers, equals, path = text.partition("=")
    parts = [part.strip() for part in numbers.split(":")]
    form = ":".join(name.upper() for name in effect.names)
    wrong = UserError(
        f"`{text}` is no file of the device", f"{form}=PATH, such as {form}=log.bin"
    )
    if not equals or not path or len(parts) != len(effect.key):
        raise wrong
    key = []
    for register, part in zip(effect.key, parts, strict=True):
        number = _number(icd, procedure, register, part)
        if number is None:
            raise wrong
        key.append(number)
    if node_facts.index and key[:1] == [node_facts.index.file_type]:
        raise UserError(
            f"`{text}`: the index file is made of the others", "leave it out"
        )
    try:
        data = Path(path).read_bytes()
        changed = datetime.fromtimestamp(Path(path).stat().st_mtime, UTC)
    except OSError as error:
        raise unreadable(path, error, "check the path after the =") from None
    try:
        packed = dos_time_pack(link_of_node(icd, node), changed)
    except IcdError:
        # The packed format cannot represent the time, for instance of a year before its
        # first one.
        packed = 0
    return effect.kind, tuple(key), Object(bytearray(data), packed)


def _number(icd: Icd, procedure: Procedure, register: int, text: str) -> int | None:
    """Return the number of an input, given as in the telecommand that has it; None if
    it does not fit.

    Raise `icdgen.errors.UserError`.
    """
    for step in steps_of(procedure, Send):
        for put in step.puts:
            if put.value != Value(register, True):
                continue
            index = number_places(icd, step.message).index(put.place)
            number = parse_physical(icd.longest_frame(step.message)[index], text)
            assert isinstance(number, int)
            return number if 0 <= number < 1 << put.place.bits else None
    return None


def saver(folder: Path | None) -> Callable[[str, Key, bytes], None] | None:
    """Return the function that stores uploaded programs in a folder."""
    if folder is None:
        return None
    if folder.exists() and not folder.is_dir():
        raise UserError(
            f"{folder} is not a folder",
            "--uploads names the folder for uploaded programs",
        )
    folder.mkdir(parents=True, exist_ok=True)

    def save(kind: str, key: Key, data: bytes) -> None:
        name = "-".join(map(str, key))
        # Replaced at once, so that no reader of the folder finds half of a program.
        partial = folder / f"{name}.bin.part"
        partial.write_bytes(data)
        partial.replace(folder / f"{name}.bin")

    return save

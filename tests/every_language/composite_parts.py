"""Composite messages: programs read each part as the message that it repeats.

The reference codec computes the expected values.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from icdgen.backends.c.names import stem
from icdgen.describe import MessageDescription, describe
from tests.conformance import composites
from tests.every_language.story import Claim, Story
from tests.python import packages


def composite_parts() -> Story:
    """The story of the composites of `tests.conformance.composites`."""
    with tempfile.TemporaryDirectory() as folder:
        icd = packages.read(composites.write(Path(folder)))
    description = describe(icd)
    claims: list[Claim] = []
    for case in composites.cases(icd):
        composite = description.message(case.message)
        for part in case.parts:
            count = sum(other.part is part.part for other in case.parts)
            message = description.message(part.part)
            claims.append(_claim(composite, case.frame, message, part, count))
    return Story(
        node="demo",
        icd=composites.DEMO,
        included={"base": composites.BASE},
        claims=tuple(claims),
        c="",
        python="from importlib import import_module\n",
        rust="",
    )


def _claim(
    composite: MessageDescription,
    frame: bytes,
    message: MessageDescription,
    part: composites.PartFrame,
    count: int,
) -> Claim:
    """One of ``count`` parts that repeat ``message``."""
    getter = f"{stem(composite)}_part_{message.name}"
    calls = f"{getter}(&message, &part);\n"
    if count > 1:
        calls = f"""\
CHECK({getter}(&message, {part.index}u, &part) == ICD_OK);
CHECK({getter}(&message, {count}u, &part) == ICD_ERROR_RANGE);
CHECK({getter}(&message, (size_t)-1, &part) == ICD_ERROR_RANGE);
"""
    of_c = f"""\
const uint8_t frame[] = {{{", ".join(map(str, frame))}}};
const uint8_t expected[] = {{{", ".join(map(str, part.frame))}}};
uint8_t encoded[sizeof expected];
{stem(composite)}_t message;
{stem(message)}_t part;
CHECK({stem(composite)}_decode(&message, frame, sizeof frame) == ICD_OK);
memset(&part, 0xa5, sizeof part);
{calls}CHECK({stem(message)}_encode(&part, encoded, sizeof encoded) == ICD_OK);
CHECK(memcmp(encoded, expected, sizeof expected) == 0);
"""
    of_python = f"""\
node = import_module(package.__name__ + ".{message.node.name}")
composite = {composite.camel_name}.from_bytes({frame!r})
part = node.{message.camel_name}.from_part(composite, {part.index})
assert type(part) is node.{message.camel_name} and part.to_bytes() == {part.frame!r}
"""
    kind = f"icd::{message.node.name}::{message.camel_name}"
    conversion = (
        f"<[{kind}; {count}]>::from(&message)[{part.index}]"
        if count > 1
        else f"{kind}::from(&message)"
    )
    of_rust = f"""\
let message = icd::{composite.node.name}::{composite.camel_name}::from_bytes(&{list(frame)}).unwrap();
assert_eq!({conversion}.to_bytes().unwrap(), {list(part.frame)});
"""
    fact = (
        f"{message.model.name} {part.index} is in {composite.model.name} {frame.hex()}"
    )
    return Claim(fact, c=of_c, python=of_python, rust=of_rust)

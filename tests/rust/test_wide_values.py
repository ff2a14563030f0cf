"""A raw value with more bits than its field is refused, and the field is named; the
largest that fits is written.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen import codec
from icdgen.backends.rust.names import field_name
from icdgen.backends.rust.text import string
from icdgen.backends.rust.types import integer_type
from icdgen.describe import describe
from icdgen.icd.model import Icd
from tests.rust.tools import USED, Toolchain, run

CASE = """\
    let mut message = icd::{node}::{type}::from_array(&[0; {length}]);
    message.{field} = {widest};
    let told = matches!(
        message.to_bytes(),
        Err(icd::Error::Range {{ field, allowed }}) if field == {title} && allowed.contains("{least} to {largest_raw}")
    );
    assert!(told, "{{}}", {title});
    message.{field} = {largest};
    assert_eq!(message.to_bytes(), Ok({bytes}), "{{}}", {title});
"""


def cases(icd: Icd) -> Iterator[str]:
    """Each narrow field with the largest value of its type, and with its own."""
    for node in describe(icd).nodes:
        for message in node.messages:
            for one in (field for field in message.fields if field.is_narrow):
                field, length = one.model, message.model.length
                zeros = codec.decode(node.model, message.model, bytes(length))
                frame = codec.encode(
                    node.model, message.model, {**zeros, field.name: field.raw_max}
                )
                kind = integer_type(one)
                coded = "Coded::from_raw({})" if field.type == "enum" else "{}"
                yield CASE.format(
                    bytes=list(frame),
                    node=node.name,
                    type=message.camel_name,
                    length=length,
                    field=field_name(one),
                    widest=coded.format(f"{kind}::MAX"),
                    largest=coded.format(f"{field.raw_max}_{kind}"),
                    title=string(field.name),
                    least=field.raw_min,
                    largest_raw=field.raw_max,
                )


def test_what_does_not_fit_is_refused_by_name(subject, tmp_path):
    tools = Toolchain("default")
    found = list(cases(subject.icd))
    assert found
    functions = "".join(
        f"fn case_{index}() {{\n{text}}}\n" for index, text in enumerate(found)
    )
    calls = "".join(f"    case_{index}();\n" for index in range(len(found)))
    source = tmp_path / "main.rs"
    source.write_text(
        f"#![allow(unused_imports)]\nuse icd::Coded;\n{functions}fn main() {{\n{calls}}}\n"
    )
    library = Toolchain("default").library(subject.crate, *USED)
    run(tools.program(source, library, tmp_path / "main"))

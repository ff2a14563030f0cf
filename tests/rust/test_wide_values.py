"""A raw value with more bits than its field: what fits is written, and nothing beside the field."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen import codec
from icdgen.backends.rust.names import field_name, integer_type, type_name
from icdgen.describe import describe
from icdgen.icd.model import Icd
from tests.rust.tools import Toolchain, run

CASE = """\
    let mut message = icd::{node}::{type}::from_array(&[0; {length}]);
    message.{field} = {value};
    assert_eq!(message.to_bytes(), {bytes}, {name});
    assert!(message.try_to_bytes().is_err(), {name});
"""


def cases(icd: Icd) -> Iterator[str]:
    """Each narrow field with all bits of its type set: its own bits are set then, and no others."""
    for node in describe(icd).nodes:
        for message in node.messages:
            for one in (field for field in message.fields if field.is_narrow):
                field, length = one.model, message.model.length
                zeros = codec.decode(node.model, message.model, bytes(length))
                ones = -1 if field.type == "int" else (1 << field.bits) - 1
                frame = codec.encode(node.model, message.model, {**zeros, field.name: ones})
                # All ones fit a signed field: it is -1. The widest value has one bit less, and is cut to the same.
                widest = "Coded::from_raw(!0)" if field.type == "enum" else f"{integer_type(one)}::MAX"
                yield CASE.format(
                    bytes=list(frame),
                    node=node.name,
                    type=type_name(message),
                    length=length,
                    field=field_name(one),
                    value=widest,
                    name=f'"{one.name}"',
                )


def test_what_does_not_fit_touches_no_other_field(subject, tmp_path):
    tools = Toolchain("default")
    found = list(cases(subject.icd))
    assert found
    functions = "".join(f"fn case_{index}() {{\n{text}}}\n" for index, text in enumerate(found))
    calls = "".join(f"    case_{index}();\n" for index in range(len(found)))
    source = tmp_path / "main.rs"
    source.write_text(f"#![allow(unused_imports)]\nuse icd::Coded;\n{functions}fn main() {{\n{calls}}}\n")
    library = tools.library(subject.crate, tmp_path, "0")
    run(tools.program(source, library, tmp_path / "main"))

"""Electronic data sheets (EDS), as `icdgen import` reads them.

No Python library decodes frames by data sheets. The reference implementation is
therefore a bit reader of our own: it walks the XML for each frame, entry by entry, and
shares no code with the importer.
"""

from __future__ import annotations

import ast
import operator
import os
import re
import struct
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from xml.etree import ElementTree

from icdgen.definitions import eds, run
from icdgen.diagnostics import Findings
from tests.conftest import ROOT
from tests.devices.definition import Definition, Definitions, NotSupported, Values

OWN = ROOT / "tests" / "definitions" / "files" / "eds"
# Environment variable: a folder with further data sheets, such as those of cFS, and
# their parameters.
OTHERS = "EDS_FILES"
_SUMS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Pow: operator.pow, ast.BitXor: operator.pow,
}  # fmt: skip


def sheets() -> Iterator[Definitions]:
    """Yield a node for each data sheet of the tests and of the folder in the
    environment.
    """
    reader = eds.Eds()
    for folder in (OWN, *map(Path, filter(None, [os.environ.get(OTHERS)]))):
        reference = _Reference(folder)
        for path in sorted(folder.glob("*.xml")):
            if not reader.knows(path.read_text("utf-8")):
                continue
            try:
                read = run.read(path, reader)
            except Findings:
                continue  # packages that only other data sheets use
            (tree,) = read.trees.values()
            missing = [
                finding.message
                for finding in read.definitions.import_findings
                if finding.severity == "error"
            ]
            # A message whose last fields are imported as bytes counts as missing.
            tree["messages"] = [
                message
                for message in tree["messages"]
                if not any(_is_cut(message, text) for text in missing)
            ]
            messages = [
                _definition(reference, reference.packages(path), message, tree)
                for message in tree["messages"]
            ]
            messages += [
                Definition(
                    finding, 0, "telemetry", 0, [], cause=finding.split(": ", 1)[1]
                )
                for finding in missing
            ]
            yield Definitions(tree["node"], messages, tree)


def _is_cut(message: dict, finding: str) -> bool:
    """Return whether a finding reports that the end of a message is imported as bytes."""
    return finding.startswith(f"message `{message['name']}`: from ")


def _definition(
    reference: _Reference, packages: list[str], message: dict, tree: dict
) -> Definition:
    # The default of data sheets.
    orders = {"byte_order": "big", "bit_order": "msb0"}
    fields = [{**orders, **field} for field in message.get("fields", ())]
    structs = [
        {**struct_, "fields": [{**orders, **part} for part in struct_["fields"]]}
        for struct_ in tree.get("structs", ())
    ]
    name = message["name"].rsplit(" ", 1)[-1]  # behind the package, if several have it
    types = (reference.types.get(f"{package}/{name}") for package in packages)
    container = next(type_ for type_ in types if type_ is not None)
    header = tree.get("protocol", {}).get("link", {}).get("header", [])
    skipped = sum(part["bits"] for part in header)  # they follow each other

    def raw(data: bytes) -> Values:
        decoded = reference.read(container, data, skipped)
        return _named(
            fields, structs, [value for value in decoded if value[1] >= skipped]
        )

    def physical(data: bytes) -> Values:
        decoded = reference.read(container, data, skipped)
        curves = {at: curve for _, at, _, curve in decoded if curve is not None}
        values = {at: value for _, at, value, _ in decoded}
        scaled = {}
        for field in fields:
            at = field["at"] + skipped
            if "formula" in field and at in curves:
                scaled[field["name"]] = curves[at](values[at])
        return scaled

    return Definition(
        message["name"],
        message["id"],
        message["kind"],
        message["length"],
        fields,
        raw=raw,
        physical=physical,
        structs=structs,
    )


Curve = Callable[[float], float]
Decoded = tuple[str, int, object, "Curve | None"]  # path, bit, raw value, calibration


def _named(fields: list[dict], structs: list[dict], decoded: list[Decoded]) -> Values:
    """Return the values by the names that the ICD gives them.

    The fields are taken in the order of their bits. Each name must be the end of the
    path in the data sheet, and no value may remain.
    """
    remaining = list(decoded)
    values: Values = {}

    def take(name: str) -> object:
        path, _, value, _ = remaining.pop(0)
        if not path.endswith(name.replace(" ", ".")):
            raise AssertionError(f"{name} is {path}")
        return value

    for field in sorted(fields, key=lambda each: each["at"]):
        name = field["name"]
        parts = next(
            (
                struct_["fields"]
                for struct_ in structs
                if struct_["name"] == field.get("struct")
            ),
            None,
        )
        count = field.get("count")
        if parts is not None:
            number = 0
            while remaining and f"{name}[{number}]" in remaining[0][0].replace(
                ".", " "
            ):
                for part in parts:
                    inner = [take(part["name"]) for _ in range(part.get("count", 1))]
                    values[f"{name}[{number}].{part['name']}"] = (
                        inner if "count" in part else inner[0]
                    )
                number += 1
        elif count is not None:
            elements = []
            while remaining and f".{remaining[0][0]}".endswith(
                f".{name.replace(' ', '.')}[{len(elements)}]"
            ):
                elements.append(remaining.pop(0)[2])
            values[name] = elements
        elif field["type"] == "bytes" and remaining[0][0].endswith(
            "[0]"
        ):  # a long array of bytes
            length = field["bits"] // 8
            values[name] = bytes(
                int(str(value)) for _, _, value, _ in remaining[:length]
            )
            del remaining[:length]
        else:
            values[name] = take(name)
    assert not remaining, remaining
    return values


class _Reference:
    """Decoder of a folder of data sheets."""

    def __init__(self, folder: Path) -> None:
        self.types: dict[str, ElementTree.Element] = {}
        self.package_of: dict[int, str] = {}
        self.defines: dict[str, str] = {}
        for path in sorted(folder.glob("*.xml")):
            for package in self._packages(path):
                name = package.get("name", "")
                for element in package.iter():
                    self.package_of[id(element)] = name
                self.defines |= {
                    f"{name}/{define.get('name')}": define.get("value", "")
                    for define in package.findall("Define")
                }
                for type_ in package.iterfind("DataTypeSet/*"):
                    self.types[f"{name}/{type_.get('name')}"] = type_

    @staticmethod
    def _packages(path: Path) -> list[ElementTree.Element]:
        text = re.sub(r'\sxmlns="[^"]*"', "", path.read_text("utf-8"), count=1)
        return ElementTree.fromstring(text.encode()).findall("Package")

    def packages(self, path: Path) -> list[str]:
        return [package.get("name", "") for package in self._packages(path)]

    def text(self, element: ElementTree.Element, key: str, default: str = "") -> str:
        return self._filled(element.get(key, default), self.package_of[id(element)])

    def _filled(self, text: str, package: str) -> str:
        def value(match: re.Match[str]) -> str:
            name = match[1] if match[1] in self.defines else f"{package}/{match[1]}"
            filled = self._filled(self.defines[name], name.rsplit("/", 1)[0])
            try:
                return str(_sum(filled))
            except (SyntaxError, ValueError):
                return filled

        return re.sub(r"\$\{([^}]*)\}", value, text)

    def number(self, element: ElementTree.Element, key: str, default: str = "") -> int:
        return int(_sum(self.text(element, key, default)))

    def type(self, element: ElementTree.Element, key: str) -> ElementTree.Element:
        name = self.text(element, key)
        type_ = self.types.get(f"{self.package_of[id(element)]}/{name}")
        return self.types[name] if type_ is None else type_

    def read(
        self, container: ElementTree.Element, data: bytes, skipped: int
    ) -> list[Decoded]:
        """Return everything in a frame, and zeros for ``skipped`` bits of its header.

        Raises `NotSupported` if a constraint is violated.
        """
        frame = _Frame(self, bytes(skipped // 8) + data, skipped)
        frame.container(container, "")
        return frame.decoded


class _Frame:
    """A frame that is being decoded."""

    def __init__(self, reference: _Reference, data: bytes, skipped: int) -> None:
        self.reference, self.data, self.skipped, self.at = reference, data, skipped, 0
        self.decoded: list[Decoded] = []

    def bits(self, count: int, is_little: bool = False) -> int:
        if self.at + count > 8 * len(self.data):
            raise NotSupported("a frame that ends too early")
        value = (
            int.from_bytes(self.data, "big") >> 8 * len(self.data) - self.at - count
            & (1 << count) - 1
        )
        self.at += count
        return (
            int.from_bytes(value.to_bytes(count // 8, "big"), "little")
            if is_little
            else value
        )

    def container(self, container: ElementTree.Element, before: str) -> None:
        """Decode a container: entries from the outermost base on, trailers in the
        opposite order.
        """
        chain = [container]
        while chain[-1].get("baseType"):
            chain.append(self.reference.type(chain[-1], "baseType"))
        for base in reversed(chain):
            for entry in base.iterfind("EntryList/*"):
                self.entry(entry, before)
        for base in chain:
            for entry in base.iterfind("TrailerEntryList/*"):
                self.entry(entry, before)
        for base in chain:
            for constraint in base.iterfind("ConstraintSet/*"):
                self.constrained(constraint, before + constraint.get("entry", ""))

    def constrained(self, constraint: ElementTree.Element, path: str) -> None:
        """Raise `NotSupported` if the value at ``path`` violates a constraint."""
        at, value = next(
            (at, value) for name, at, value, _ in reversed(self.decoded) if name == path
        )
        if at < self.skipped:  # of the header, which the frame does not contain
            return
        if constraint.tag == "ValueConstraint":
            expected = self.reference.text(constraint, "value")
            if re.fullmatch("(0x)?[0-9A-Fa-f]+", expected) and value != int(
                expected, 0
            ):
                raise NotSupported(f"{path} is not {expected}")
        else:
            (limits,) = constraint
            if (
                not self.reference.number(limits, "min")
                <= int(str(value))
                <= self.reference.number(limits, "max")
            ):
                raise NotSupported(f"{path} is not in its range")

    def entry(self, entry: ElementTree.Element, before: str) -> None:
        """Decode an entry, which can be an array, a list with a counter, or padding."""
        if entry.tag == "PaddingEntry":
            self.at += self.reference.number(entry, "sizeInBits")
            return
        type_, path, count = (
            self.reference.type(entry, "type"),
            before + entry.get("name", ""),
            1,
        )
        sizes = [entry.findall("ArrayDimensions/Dimension")]
        is_array = bool(sizes[0])
        while type_.tag == "ArrayDataType":
            sizes.append(type_.findall("DimensionList/Dimension"))
            type_, is_array = self.reference.type(type_, "dataTypeRef"), True
        for size in chain.from_iterable(sizes):
            if size.get("indexTypeRef"):
                labels = self.reference.type(size, "indexTypeRef").findall(
                    "EnumerationList/Enumeration"
                )
                values = [int(label.get("value", "0")) for label in labels]
                count *= max(values) - min(values) + 1
            else:
                count *= self.reference.number(size, "size")
        if entry.tag == "ListEntry":
            is_array = True
            counter = before + entry.get("listLengthField", "")
            count = next(
                int(str(value)) for name, _, value, _ in self.decoded if name == counter
            )
        for number in range(count):
            where = (
                f"{path}[{number}]"
                if is_array and (count > 1 or entry.tag == "ListEntry")
                else path
            )
            if type_.tag == "ContainerDataType":
                self.container(type_, f"{where}.")
            else:
                at = self.at
                self.decoded.append(
                    (where, at, self.scalar(type_, entry), _curve(entry))
                )

    def scalar(self, type_: ElementTree.Element, entry: ElementTree.Element) -> object:
        """Decode a single value by its encoding, which the entry can replace."""
        reference = self.reference
        while type_.tag == "SubRangeDataType":
            type_ = reference.type(type_, "baseType")
        encoding = next(
            (
                element
                for element in (*entry, *type_)
                if element.tag.endswith("DataEncoding")
            ),
            None,
        )
        if type_.tag == "StringDataType":
            size = reference.number(type_, "length")
            if type_.get("fixedLength") == "false":
                size = len(self.data) - self.at // 8
            value = self.bits(8 * size).to_bytes(size, "big")
            return (
                int.from_bytes(value, "big")
                if entry.tag == "FixedValueEntry"
                else value
            )
        if type_.tag == "BinaryDataType":
            size = reference.number(type_, "sizeInBits")
            return self.bits(size).to_bytes(size // 8, "big")
        if encoding is None:
            assert type_.tag == "BooleanDataType"
            return self.bits(1)
        size = reference.number(encoding, "sizeInBits")
        value = self.bits(size, reference.text(encoding, "byteOrder") == "littleEndian")
        if reference.text(encoding, "encodingAndPrecision").startswith("IEEE754"):
            kind = {32: "f", 64: "d"}[size]
            return float(struct.unpack(f">{kind}", value.to_bytes(size // 8, "big"))[0])
        if (
            reference.text(encoding, "encoding") == "twosComplement"
            and value >> size - 1
        ):
            value -= 1 << size
        return value


def _curve(entry: ElementTree.Element) -> Curve | None:
    """Return the polynomial of an entry as a function of the raw value."""
    elements = entry.iterfind("PolynomialCalibrator/Term")
    terms = [
        (float(term.get("coefficient", "")), int(term.get("exponent", "")))
        for term in elements
    ]
    return (
        (lambda raw: sum(factor * raw**power for factor, power in terms))
        if terms
        else None
    )


def _sum(text: str) -> int:
    """Evaluate an arithmetic expression of a data sheet."""

    def value(node: ast.AST) -> int:
        if isinstance(node, ast.Constant):
            return int(node.value)  # type: ignore[arg-type]
        if isinstance(node, ast.BinOp):
            return int(_SUMS[type(node.op)](value(node.left), value(node.right)))
        raise ValueError(text)

    return value(
        ast.parse(
            re.sub(r"\b0+(?=[0-9])", "", text).replace("^", "**").strip(), mode="eval"
        ).body
    )

"""Electronic data sheets, as `icdgen import` reads them.

No library reads frames by them from Python, so a reader of bits judges that is written
for this: it walks the XML for each frame, entry by entry, and shares no code with what
is judged.
"""

from __future__ import annotations

import ast
import operator
import os
import re
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree

from icdgen.definitions import eds, run
from icdgen.diagnostics import Findings
from tests.conftest import ROOT
from tests.devices.definition import Definition, Definitions, NotSupported, Values

OWN = ROOT / "tests" / "definitions" / "files" / "eds"
# In the environment: a folder with data sheets of others, such as those of cFS, and
# their parameters.
OTHERS = "EDS_FILES"
_SUMS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Pow: operator.pow, ast.BitXor: operator.pow,
}  # fmt: skip


def sheets() -> Iterator[Definitions]:
    """A node for each data sheet of ours, and of the folder that the environment names."""
    reader = eds.Eds()
    for folder in (OWN, *map(Path, filter(None, [os.environ.get(OTHERS)]))):
        judge = _Judge(folder)
        for path in sorted(folder.glob("*.xml")):
            if not reader.knows(path.read_text("utf-8")):
                continue
            try:
                read = run.read(path, reader)
            except Findings:
                continue  # of what only others use
            (tree,) = read.trees.values()
            missing = [
                one.message
                for one in read.definitions.import_findings
                if one.severity == "error"
            ]
            # a message that ends in bytes for fields which are not imported counts as
            # one that is missing
            tree["messages"] = [
                one
                for one in tree["messages"]
                if not any(_is_cut(one, text) for text in missing)
            ]
            messages = [
                _definition(judge, judge.packages(path), one, tree)
                for one in tree["messages"]
            ]
            messages += [
                Definition(said, 0, "telemetry", 0, [], cause=said.split(": ", 1)[1])
                for said in missing
            ]
            yield Definitions(tree["node"], messages, tree)


def _is_cut(message: dict, finding: str) -> bool:
    """Whether a finding says that only bytes are held of the end of a message."""
    return finding.startswith(f"message `{message['name']}`: from ")


def _definition(
    judge: _Judge, packages: list[str], held: dict, tree: dict
) -> Definition:
    orders = {"byte_order": "big", "bit_order": "msb0"}
    fields = [{**orders, **one} for one in held.get("fields", ())]
    structs = [
        {**one, "fields": [{**orders, **part} for part in one["fields"]]}
        for one in tree.get("structs", ())
    ]
    name = held["name"].rsplit(" ", 1)[-1]  # behind the package, if several have it
    container = next(
        found
        for found in (judge.types.get(f"{one}/{name}") for one in packages)
        if found is not None
    )
    header = tree.get("protocol", {}).get("link", {}).get("header", [])
    skipped = sum(one["bits"] for one in header)  # they follow each other

    def raw(data: bytes) -> Values:
        return _named(
            fields,
            structs,
            [one for one in judge.read(container, data, skipped) if one[1] >= skipped],
        )

    def physical(data: bytes) -> Values:
        found = judge.read(container, data, skipped)
        curves = {at: curve for _, at, _, curve in found if curve is not None}
        values = {at: value for _, at, value, _ in found}
        return {
            one["name"]: curves[one["at"] + skipped](values[one["at"] + skipped])
            for one in fields if "formula" in one and one["at"] + skipped in curves
        }  # fmt: skip

    return Definition(
        held["name"],
        held["id"],
        held["kind"],
        held["length"],
        fields,
        raw=raw,
        physical=physical,
        structs=structs,
    )


Curve = Callable[[float], float]
Found = tuple[str, int, object, "Curve | None"]  # path, bit, raw value, calibration


def _named(fields: list[dict], structs: list[dict], found: list[Found]) -> Values:
    """Values by the names that the ICD gives them: in the order of the bits, each name
    the end of a path, and none left over.
    """
    left = list(found)
    values: Values = {}

    def take(name: str) -> object:
        path, _, value, _ = left.pop(0)
        if not path.endswith(name.replace(" ", ".")):
            raise AssertionError(f"{name} is {path}")
        return value

    for one in sorted(fields, key=lambda field: field["at"]):
        name = one["name"]
        parts = next(
            (of["fields"] for of in structs if of["name"] == one.get("struct")), None
        )
        count = one.get("count")
        if parts is not None:
            number = 0
            while left and f"{name}[{number}]" in left[0][0].replace(".", " "):
                for part in parts:
                    inner = [take(part["name"]) for _ in range(part.get("count", 1))]
                    values[f"{name}[{number}].{part['name']}"] = (
                        inner if "count" in part else inner[0]
                    )
                number += 1
        elif count is not None:
            several = []
            while left and f".{left[0][0]}".endswith(
                f".{name.replace(' ', '.')}[{len(several)}]"
            ):
                several.append(left.pop(0)[2])
            values[name] = several
        elif one["type"] == "bytes" and left[0][0].endswith(
            "[0]"
        ):  # a long array of bytes
            length = one["bits"] // 8
            values[name] = bytes(int(str(value)) for _, _, value, _ in left[:length])
            del left[:length]
        else:
            values[name] = take(name)
    assert not left, left
    return values


class _Judge:
    """A folder of data sheets."""

    def __init__(self, folder: Path) -> None:
        self.types: dict[str, ElementTree.Element] = {}
        self.of: dict[int, str] = {}
        self.defines: dict[str, str] = {}
        for path in sorted(folder.glob("*.xml")):
            for package in self._packages(path):
                name = package.get("name", "")
                for one in package.iter():
                    self.of[id(one)] = name
                self.defines |= {
                    f"{name}/{one.get('name')}": one.get("value", "")
                    for one in package.findall("Define")
                }
                for one in package.iterfind("DataTypeSet/*"):
                    self.types[f"{name}/{one.get('name')}"] = one

    @staticmethod
    def _packages(path: Path) -> list[ElementTree.Element]:
        text = re.sub(r'\sxmlns="[^"]*"', "", path.read_text("utf-8"), count=1)
        return ElementTree.fromstring(text.encode()).findall("Package")

    def packages(self, path: Path) -> list[str]:
        return [one.get("name", "") for one in self._packages(path)]

    def text(self, of: ElementTree.Element, key: str, default: str = "") -> str:
        return self._filled(of.get(key, default), self.of[id(of)])

    def _filled(self, text: str, package: str) -> str:
        def value(found: re.Match[str]) -> str:
            name = found[1] if found[1] in self.defines else f"{package}/{found[1]}"
            filled = self._filled(self.defines[name], name.rsplit("/", 1)[0])
            try:
                return str(_sum(filled))
            except (SyntaxError, ValueError):
                return filled

        return re.sub(r"\$\{([^}]*)\}", value, text)

    def number(self, of: ElementTree.Element, key: str, default: str = "") -> int:
        return int(_sum(self.text(of, key, default)))

    def type(self, of: ElementTree.Element, key: str) -> ElementTree.Element:
        name = self.text(of, key)
        found = self.types.get(f"{self.of[id(of)]}/{name}")
        return self.types[name] if found is None else found

    def read(
        self, container: ElementTree.Element, data: bytes, skipped: int
    ) -> list[Found]:
        """Everything in a frame, and zeros of its header of so many bits.

        Raises `NotSupported` where a constraint is broken.
        """
        frame = _Frame(self, bytes(skipped // 8) + data, skipped)
        frame.container(container, "")
        return frame.found


class _Frame:
    """A frame that is being read."""

    def __init__(self, judge: _Judge, data: bytes, skipped: int) -> None:
        self.judge, self.data, self.skipped, self.at = judge, data, skipped, 0
        self.found: list[Found] = []

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

    def container(self, of: ElementTree.Element, before: str) -> None:
        chain = [of]
        while chain[-1].get("baseType"):
            chain.append(self.judge.type(chain[-1], "baseType"))
        for one in reversed(chain):
            for entry in one.iterfind("EntryList/*"):
                self.entry(entry, before)
        for one in chain:
            for entry in one.iterfind("TrailerEntryList/*"):
                self.entry(entry, before)
        for one in (
            constraint for of in chain for constraint in of.iterfind("ConstraintSet/*")
        ):
            self.constrained(one, before + one.get("entry", ""))

    def constrained(self, one: ElementTree.Element, path: str) -> None:
        at, value = next(
            (at, value) for name, at, value, _ in reversed(self.found) if name == path
        )
        if at < self.skipped:  # of a header that is not there
            return
        if one.tag == "ValueConstraint":
            said = self.judge.text(one, "value")
            if re.fullmatch("(0x)?[0-9A-Fa-f]+", said) and value != int(said, 0):
                raise NotSupported(f"{path} is not {said}")
        else:
            (limits,) = one
            if (
                not self.judge.number(limits, "min")
                <= int(str(value))
                <= self.judge.number(limits, "max")
            ):
                raise NotSupported(f"{path} is not in its range")

    def entry(self, entry: ElementTree.Element, before: str) -> None:
        if entry.tag == "PaddingEntry":
            self.at += self.judge.number(entry, "sizeInBits")
            return
        type_, path, count = (
            self.judge.type(entry, "type"),
            before + entry.get("name", ""),
            1,
        )
        sizes = [entry.findall("ArrayDimensions/Dimension")]
        is_array = bool(sizes[0])
        while type_.tag == "ArrayDataType":
            sizes.append(type_.findall("DimensionList/Dimension"))
            type_, is_array = self.judge.type(type_, "dataTypeRef"), True
        for size in (one for of in sizes for one in of):
            if size.get("indexTypeRef"):
                labels = self.judge.type(size, "indexTypeRef").findall(
                    "EnumerationList/Enumeration"
                )
                values = [int(one.get("value", "0")) for one in labels]
                count *= max(values) - min(values) + 1
            else:
                count *= self.judge.number(size, "size")
        if entry.tag == "ListEntry":
            is_array = True
            counter = before + entry.get("listLengthField", "")
            count = next(
                int(str(value)) for name, _, value, _ in self.found if name == counter
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
                self.found.append((where, at, self.scalar(type_, entry), _curve(entry)))

    def scalar(self, type_: ElementTree.Element, entry: ElementTree.Element) -> object:
        judge = self.judge
        while type_.tag == "SubRangeDataType":
            type_ = judge.type(type_, "baseType")
        encoding = next(
            (
                one
                for of in (entry, type_)
                for one in of
                if one.tag.endswith("DataEncoding")
            ),
            None,
        )
        if type_.tag == "StringDataType":
            size = judge.number(type_, "length")
            if type_.get("fixedLength") == "false":
                size = len(self.data) - self.at // 8
            value = self.bits(8 * size).to_bytes(size, "big")
            return (
                int.from_bytes(value, "big")
                if entry.tag == "FixedValueEntry"
                else value
            )
        if type_.tag == "BinaryDataType":
            size = judge.number(type_, "sizeInBits")
            return self.bits(size).to_bytes(size // 8, "big")
        if encoding is None:
            assert type_.tag == "BooleanDataType"
            return self.bits(1)
        size = judge.number(encoding, "sizeInBits")
        value = self.bits(size, judge.text(encoding, "byteOrder") == "littleEndian")
        if judge.text(encoding, "encodingAndPrecision").startswith("IEEE754"):
            kind = {32: "f", 64: "d"}[size]
            return float(struct.unpack(f">{kind}", value.to_bytes(size // 8, "big"))[0])
        if judge.text(encoding, "encoding") == "twosComplement" and value >> size - 1:
            value -= 1 << size
        return value


def _curve(entry: ElementTree.Element) -> Curve | None:
    """A polynomial as it stands there."""
    found = entry.iterfind("PolynomialCalibrator/Term")
    terms = [
        (float(one.get("coefficient", "")), int(one.get("exponent", "")))
        for one in found
    ]
    return (
        (lambda raw: sum(factor * raw**power for factor, power in terms))
        if terms
        else None
    )


def _sum(text: str) -> int:
    """A sum of numbers, as Python computes it."""

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

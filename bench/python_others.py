"""Decoders by other libraries, built from the field descriptions of a generated class.

`by_construct` and `by_kaitaistruct` take a generated message class and return a
function that decodes one frame, for ``python_decode`` and ``nav_sat`` to measure. Both
support only little-endian frames, and `by_construct` no structs. The libraries must be
installed; they are imported when a function is called.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from typing import Any


def by_construct(cls: Any) -> Callable[[bytes], Any]:
    """Return a decoder as a user of construct would write it.

    Construct reads bits most significant first, so the bits of each byte are swapped.
    """
    import construct

    integers = {
        8: construct.Int8ul,
        16: construct.Int16ul,
        32: construct.Int32ul,
        64: construct.Int64ul,
    }
    signed = {
        8: construct.Int8sl,
        16: construct.Int16sl,
        32: construct.Int32sl,
        64: construct.Int64sl,
    }
    floats = {32: construct.Float32l, 64: construct.Float64l}

    def kind(info: Any) -> Any:
        if info.type == "bytes":
            return construct.Bytes(info.bits // 8)
        number = {"int": signed, "float": floats}.get(info.type, integers)[info.bits]
        return construct.Enum(number, info.enum) if info.enum else number

    parts, bits, reached = [], [], 0

    def close() -> None:
        if bits:
            parts.append(
                construct.BitsSwapped(
                    construct.BitStruct(*bits, construct.Padding(-reached % 8))
                )
            )
            bits.clear()

    for info in cls.FIELDS:
        if info.bits % 8 and info.at % 8 + info.bits <= 8:
            if bits and info.at != reached:
                bits.append(construct.Padding(info.at - reached))
            inner = (
                construct.Flag
                if info.type == "bool"
                else construct.BitsInteger(info.bits)
            )
            bits.append(
                info.attribute
                / (construct.Enum(inner, info.enum) if info.enum else inner)
            )
        else:
            close()
            parts.append(info.attribute / kind(info))
        reached = info.at + info.bits
    close()
    return construct.Struct(*parts).parse


def by_kaitaistruct(cls: Any) -> Callable[[bytes], Any]:
    """Return the decoder that the Kaitai Struct compiler would generate for the frame.

    Structs have a class each; the preceding field determines their number.
    """
    from kaitaistruct import KaitaiStream, KaitaiStruct

    names: dict[str, Any] = {"KaitaiStruct": KaitaiStruct, "KaitaiStream": KaitaiStream}
    enums: dict[str, Any] = {}
    source = _kaitai_class("Frame", cls, enums)
    exec(source, names)
    for name, enum in enums.items():
        setattr(names["Frame"], name, enum)
    return names["Frame"].from_bytes


def _kaitai_class(title: str, cls: Any, enums: dict[str, Any]) -> str:
    """Return the source of the class of a frame or struct, preceded by the classes of
    its structs.
    """
    lines, structs, reached = [], "", 0
    for info in cls.FIELDS:
        if info.at > reached and (info.at % 8 or reached % 8):
            lines.append(
                f"        self._io.read_bits_int_le({min(info.at, -(-reached // 8) * 8) - reached})\n"
            )
            reached = min(info.at, -(-reached // 8) * 8)
        if info.at > reached and info.at % 8 == reached % 8 == 0:
            lines.append(f"        self._io.read_bytes({(info.at - reached) // 8})\n")
        reached = info.at + info.bits
        if info.struct:
            structs += _kaitai_class(info.struct.__name__, info.struct, enums)
            struct_call = f"{info.struct.__name__}(self._io, self, self._root)"
            count = (
                f"range(self.{cls.TAIL.counter})"
                if info.is_open
                else f"range({info.elements})"
            )
            read = f"[{struct_call} for _ in {count}]" if info.elements else struct_call
        elif info.type == "bytes":
            read = f"self._io.read_bytes({info.bits // 8})"
        elif info.bits % 8:
            read = f"self._io.read_bits_int_le({info.bits})"
        else:
            suffix = "le" if info.bits > 8 else ""
            read = f"self._io.read_{ {'int': 's', 'float': 'f'}.get(info.type, 'u') }{info.bits // 8}{suffix}()"
        if info.type == "bool":
            read += " != 0"
        if info.enum:
            enums[info.enum.__name__] = IntEnum(
                info.enum.__name__, {member.name: member.value for member in info.enum}
            )
            read = f"KaitaiStream.resolve_enum(Frame.{info.enum.__name__}, {read})"
        lines.append(f"        self.{info.attribute} = {read}\n")
    if reached % 8:
        lines.append("        self._io.align_to_byte()\n")
    return (
        f"{structs}class {title}(KaitaiStruct):\n"
        "    def __init__(self, _io, _parent=None, _root=None):\n"
        f"        super({title}, self).__init__(_io)\n"
        "        self._parent = _parent\n        self._root = _root or self\n        self._read()\n"
        f"    def _read(self):\n{''.join(lines)}"
    )

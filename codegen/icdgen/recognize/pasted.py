"""Conversion of pasted text to bytes or CAN packets. The spelling is detected.

Supported are hexadecimal digits in many notations, source text of C and Python, dumps
with addresses (``dumps``), CAN logs (``packets``), decimal numbers and base64.
"""

from __future__ import annotations

import base64
import binascii
import re
from contextlib import suppress
from dataclasses import dataclass

from icdgen.recognize.dumps import dump
from icdgen.recognize.packets import Printed, packets
from icdgen.values.errors import BadHex
from icdgen.values.hexadecimal import parse_hex

_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_LIST = re.compile(r"[\[{(]([^\[\]{}()]*)[\]})][)\]}\s;]*\Z")
_NUMBERS = re.compile(
    r"\s*(?:0[xX][0-9A-Fa-f]+|\d+)(?:[uU](?:8)?)?(?:\s*,\s*(?:0[xX][0-9A-Fa-f]+|\d+)(?:[uU](?:8)?)?)*\s*,?\s*"
)
_LITERAL = re.compile(
    r"""(?:bytearray\()?b(["'])((?:\\.|(?!\1)[^\\])*\\(?:\\.|(?!\1)[^\\]|.)*)\1\)?""",
    re.DOTALL,
)
_STRING = re.compile(r"""(["'])([0-9A-Fa-f\s]+)\1""")
_ESCAPE = re.compile(r"\\(x[0-9A-Fa-f]{2}|.)|([^\\])", re.DOTALL)
_ESCAPED = {
    "n": 10,
    "r": 13,
    "t": 9,
    "0": 0,
    "a": 7,
    "b": 8,
    "f": 12,
    "v": 11,
    "\\": 92,
    "'": 39,
    '"': 34,
}
_BASE64 = re.compile(
    r"(?:[A-Za-z0-9+/_-]{4})*(?:[A-Za-z0-9+/_-]{2}==|[A-Za-z0-9+/_-]{3}=)?"
)
_MARKED = re.compile(
    r"""(["'])(0[xX][0-9A-Fa-f]{1,2}|[0-9A-Fa-f]{2})\1|<([0-9A-Fa-f]{2})>|\b([0-9A-Fa-f]{2})[hH]\b""",
    re.ASCII,
)
_DECIMALS = re.compile(r"[0-9]{1,3}(?:[\s,;]+[0-9]{1,3})+")
# Date and time at the beginning of a line, before the data.
_DATE = r"^[ \t]*\d{4}-\d\d-\d\d[T ]\d+:\d\d[\d:.,]*[ \t]+"
_LABEL = re.compile(
    r"^[ \t]*(?:\[[^\]\n]*\][ \t]*)?(?:(?:\d{4}-\d\d-\d\d[T ])?\d+:\d\d[\d:.,]*[ \t]+)?"
    r"(?:(?:[rRtT][xX]|recv|sent|send|frame)[ \t]*[:>]?|<+|>+|<-|->)[ \t]+|" + _DATE,
    re.MULTILINE | re.ASCII,
)
_DATE_LABEL = re.compile(_DATE, re.MULTILINE | re.ASCII)


@dataclass(frozen=True, slots=True)
class Pasted:
    """Bytes, or packets if the text is the output of a CAN tool.

    ``form`` is the name of the spelling; empty for hexadecimal digits.
    """

    data: bytes = b""
    packets: tuple[Printed, ...] = ()
    form: str = ""

    @property
    def whole(self) -> bytes:
        """All bytes, with the data of the packets joined."""
        return b"".join(packet.data for packet in self.packets) or self.data


def read_pasted(text: str) -> Pasted:
    """Return the bytes or packets of a text.

    Raise `BadHex`, with the position of the error.
    """
    # From the strictest spelling to the most lenient one: `10 20 30` is hexadecimal,
    # decimal and, without blanks, base64.
    if can_packets := packets(text):
        return Pasted(packets=tuple(can_packets))
    if (data := dump(text)) is not None:
        return Pasted(data, form="a dump with addresses")
    literal = _LITERAL.fullmatch(text.strip())
    if literal and (data := _unescaped(literal[2])) is not None:
        return Pasted(data)
    # Without a fraction of a second, date and time are pairs of hexadecimal digits too.
    if _DATE_LABEL.search(text) and (pasted := _labelled(text)):
        return pasted
    try:
        return Pasted(parse_hex(text))
    except BadHex:
        pasted = (
            _of_code(_COMMENT.sub(" ", text))
            or _labelled(text)
            or _marked(text)
            or _decimal(text)
            or _base64(text)
        )
        if pasted is None:
            raise
        return pasted


def _unescaped(text: str) -> bytes | None:
    """Return the bytes of a Python bytes literal; None if it has an unknown escape."""
    result = bytearray()
    for escape, plain in _ESCAPE.findall(text):
        if plain:
            value = ord(plain)
        elif len(escape) > 1:
            value = int(escape[1:], 16)
        else:
            # 256 is no byte: an unknown escape makes the text no literal.
            value = _ESCAPED.get(escape, 256)
        if value > 255:
            return None
        result.append(value)
    return bytes(result)


def _of_code(text: str) -> Pasted | None:
    """Return the bytes of an array or string in the source text of a program."""
    text = text.strip().rstrip(";").strip()
    strings = _STRING.findall(text)
    if len(strings) == 1:
        return _hex(strings[0][1])
    listed = _LIST.search(text)
    if not listed or not _NUMBERS.fullmatch(listed[1]):
        return None
    words = [
        re.sub(r"(?<=[0-9A-Fa-f])[uU]8?$", "", word.strip())
        for word in listed[1].split(",")
        if word.strip()
    ]
    values = [int(word, 16 if word[:2] in ("0x", "0X") else 10) for word in words]
    # Up to 9 a decimal number is the same in hexadecimal, so the form needs no remark.
    is_decimal = any(
        value > 9 and word[:2] not in ("0x", "0X")
        for word, value in zip(words, values, strict=True)
    )
    if max(values) > 255:
        return None
    return Pasted(bytes(values), form="decimal numbers" if is_decimal else "")


def _labelled(text: str) -> Pasted | None:
    """Return the bytes of a log whose lines begin with a time or a direction."""
    bare = _LABEL.sub("", text)
    return _hex(bare) if bare != text else None


def _marked(text: str) -> Pasted | None:
    """Return the bytes if each is in quotes or angle brackets, or followed by ``h``."""
    bare = _MARKED.sub(lambda match: f" {match[2] or match[3] or match[4]} ", text)
    return _hex(bare) if bare != text else None


def _decimal(text: str) -> Pasted | None:
    """Return the bytes of decimal numbers."""
    words = re.findall("[0-9]+", text) if _DECIMALS.fullmatch(text.strip()) else []
    if not words or max(map(int, words)) > 255:
        return None
    return Pasted(bytes(map(int, words)), form="decimal numbers")


def _base64(text: str) -> Pasted | None:
    """Return the bytes of a base64 text."""
    joined = "".join(text.split())
    # Many mistyped words are valid base64, too.
    is_word = len(joined) < 8 or joined in (joined.lower(), joined.upper())
    if not _BASE64.fullmatch(joined) or (is_word and not joined.endswith("=")):
        return None
    # RFC 4648 has two alphabets, which differ in two characters.
    alternative_characters = b"-_" if set("-_") & set(joined) else b"+/"
    with suppress(binascii.Error):
        data = base64.b64decode(joined, altchars=alternative_characters)
        return Pasted(data, form="base64")
    return None


def _hex(text: str) -> Pasted | None:
    with suppress(BadHex):
        return Pasted(parse_hex(text))
    return None

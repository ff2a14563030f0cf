"""Formulas in running text: ``(formatted value) [deg] = RAWVAL*0.01`` and its variants,
in both directions, and factors in columns of their own.

A text and the names of raw and physical values go in. The formula comes out in the
notation of the ICD, or None if it cannot be read completely: part of a formula would be
a wrong scale.
"""

from __future__ import annotations

import re
from functools import lru_cache

from icdgen.frozen import NamedTuple
from icdgen.icd import formula as formulas
from icdgen.importer.words import plain, tidy_unit

_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)?(?:[eE][-+]?[0-9]{1,2})?|\.[0-9]+")
_TIMES = {
    "×": "*",
    "·": "*",
    "∙": "*",
    "⋅": "*",
    "∗": "*",
    "x": "*",
    "X": "*",
    "÷": "/",
    "–": "-",
    "−": "-",
    ":": "/",
}
# A colon divides in `RAWVAL:10` and `RAWVAL : 10`. In `RAWVAL: 10 means off` it ends
# the formula: blanks tell them apart.
_OPERATOR = re.compile(
    r"[*/×·∙⋅∗÷+−–-]|[xX](?=\s*[0-9(.])|:(?=[0-9(.])|(?<=\s):(?=\s*[0-9(.])"
)


# Continuation of an expression that is not supported: a power, a decimal comma, a name.
_GOES_ON = re.compile(r"\s*[*/×·÷^²³]|\s*:\s*[0-9(.]|,[0-9]|[A-Za-z_%]|\s*[+]")


class ReadFormula(NamedTuple):
    """A formula in the notation of the ICD.

    ``gives`` is its result, "raw" or "physical".
    """

    formula: str
    unit: str
    gives: str
    start: int
    end: int


class ValueNames(NamedTuple):
    """Names of raw and physical values in a manual."""

    raw: re.Pattern[str]
    physical: re.Pattern[str]


@lru_cache(maxsize=8)
def value_names(raw: tuple[str, ...], physical: tuple[str, ...]) -> ValueNames:
    return ValueNames(_pattern_of_names(raw), _pattern_of_names(physical))


def _pattern_of_names(names: tuple[str, ...]) -> re.Pattern[str]:
    # Longer names first: a pattern takes the first alternative that matches, and one
    # name can begin another.
    longest_first = sorted(names, key=len, reverse=True)
    any_name = "|".join(
        re.escape(name).replace(r"\ ", r"\s+") for name in longest_first
    )
    return re.compile(
        rf"(?:\(\s*(?:{any_name})\s*\)|(?<![A-Za-z])(?:{any_name})(?![A-Za-z]))", re.I
    )


def find_formula(text: str, names: ValueNames) -> ReadFormula | None:
    """Return the first formula of the text that can be read, or None."""
    for sign in re.finditer("=", text):
        left = _left(text[: sign.start()], names)
        if left is None:
            continue
        gives, unit, start = left
        variable = names.raw if gives == "physical" else names.physical
        expression, end = _expression(
            text, sign.end(), variable, "raw" if gives == "physical" else "value"
        )
        if expression and _is_formula(
            candidate := expression if gives == "physical" else f"raw = {expression}"
        ):
            return ReadFormula(candidate, unit, gives, start, end)
    return None


class Scaled(NamedTuple):
    """The formula of a factor ("" for the factor 1), and the unit after it."""

    formula: str
    unit: str = ""


_FACTOR = re.compile(
    r"\s*(?:LSB\s*=\s*|[x×*]\s*)?(?:(?P<power>2\s*\^\s*[-−–]?\s*[0-9]{1,2})|(?P<over>1\s*/\s*[0-9]+)|"
    r"(?P<number>[0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]{1,2})?))\s*"
    r"(?P<unit>(?:[^\W\d_]|[°%µΩ\[])[^\s/]*?(?:/[^\s/]+?)??)?\s*(?:/\s*(?:LSB|bit|digit|count)|per (?:LSB|bit|digit|count))?\s*\Z",
    re.I,
)


def formula_of_step(text: str, names: ValueNames | None) -> Scaled | None:
    """Read a cell of a column of formulas or factors: an expression of the raw value, a
    factor (``0.01``, ``1e-7``, ``2^-20``, ``1/256``), or a factor with its unit (``10
    mV/LSB``).

    None for any other text.
    """
    if names is not None:
        announced = find_formula(text, names)
        if announced:
            return Scaled(announced.formula)
        expression, end = _expression(text, 0, names.raw, "raw")
        if expression and not text[end:].strip() and _is_formula(expression):
            return Scaled(expression)
    match = _FACTOR.match(plain(text))
    if match is None:
        return None
    if match["power"]:
        exponent = int(
            re.sub(r"[−–]", "-", match["power"].split("^")[1].replace(" ", ""))
        )
        formula = ""
        if exponent < 0:
            formula = f"raw/{2**-exponent}"
        elif exponent > 0:
            formula = f"raw*{2**exponent}"
    elif match["over"]:
        formula = f"raw/{match['over'].split('/')[1].strip()}"
    else:
        number = match["number"] if match["number"][0] != "." else "0" + match["number"]
        formula = "" if float(number) == 1 else f"raw*{number}"
    if formula and not _is_formula(formula):
        return None
    return Scaled(formula, tidy_unit(match["unit"] or ""))


def mentions_formula(text: str, names: ValueNames) -> bool:
    """Return whether the text contains something like a formula."""
    return any(_left(text[: sign.start()], names) for sign in re.finditer("=", text))


def _left(before: str, names: ValueNames) -> tuple[str, str, int] | None:
    """Read the left side of an equation: its value, the unit, and the position at which
    it begins.
    """
    bare = before.rstrip()
    unit = ""
    bracket = re.search(r"\[\s*([^\[\]]*?)\s*\]\Z", bare)
    if bracket:
        unit, bare = tidy_unit(bracket[1]), bare[: bracket.start()].rstrip()
    for gives, pattern in (("physical", names.physical), ("raw", names.raw)):
        last = None
        for match in pattern.finditer(bare):
            last = match
        if last is not None and last.end() == len(bare):
            return gives, unit, last.start()
    return None


def _expression(
    text: str, at: int, variable: re.Pattern[str], name: str
) -> tuple[str, int]:
    """Return the longest expression from ``at`` on in the notation of the ICD, and its
    end.

    ``variable`` matches the names of the value, which is called ``name`` in the result.
    The expression is "" if it does not contain the value, or continues in a way that is
    not supported.
    """
    tokens: list[str] = []
    # Number of tokens of the longest complete expression so far, and its end.
    complete, end = 0, at
    depth = 0  # open parentheses
    is_operand_next, has_variable = True, False
    while True:
        while at < len(text) and text[at].isspace():
            at += 1
        if at >= len(text):
            break
        if is_operand_next:
            match = variable.match(text, at) or _NUMBER.match(text, at)
            if match:
                is_name = variable.match(text, at) is not None
                has_variable = has_variable or is_name
                number = match.group()
                if is_name:
                    tokens.append(name)
                else:
                    tokens.append("0" + number if number[0] == "." else number)
                at, is_operand_next = match.end(), False
            elif text[at] == "(":
                tokens.append("(")
                at, depth = at + 1, depth + 1
            elif text[at] in "-−–" and (not tokens or tokens[-1] == "("):
                tokens.append("-")
                at += 1
            else:
                break
        elif text[at] == ")" and depth:
            tokens.append(")")
            at, depth = at + 1, depth - 1
        elif match := _OPERATOR.match(text, at):
            sign = match.group()
            tokens.append(_TIMES.get(sign, sign))
            at, is_operand_next = match.end(), True
        else:
            break
        # Complete so far. What follows may be text and no part of the formula.
        if depth == 0 and not is_operand_next:
            complete, end = len(tokens), at
    if not has_variable or name not in tokens[:complete] or _GOES_ON.match(text, end):
        return "", at
    return _spelled(tokens[:complete]), end


def _spelled(tokens: list[str]) -> str:
    """Return an expression as text, with blanks around plus and minus only:
    ``raw*0.01``, ``(raw - 32)*5/9``.
    """
    text = ""
    for index, token in enumerate(tokens):
        unary = index == 0 or tokens[index - 1] == "("
        text += f" {token} " if token in "+-" and not unary else token
    return text


def _is_formula(text: str) -> bool:
    try:
        formulas.parse(text)
    except formulas.FormulaError:
        return False
    return True

"""Units that every ICD can use without declaring them.

An ICD declares further units with the key `units`. `STANDARD` maps each symbol to its
`Unit`; nothing here converts values. Importers replace the symbols in `SIGNS`.
`similar_unit` returns the unit that an unknown symbol probably means (rule ICD042).
`declared` makes the list `units` for imported ICDs.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache

from icdgen.frozen import NamedTuple
from icdgen.suggest import close_to


class Unit(NamedTuple):
    """Unit of a physical value."""

    symbol: str
    identifier: str  # last part of names in generated code: ``roll_deg``
    quantity: str
    summary: str = ""


_TABLE = """
deg         deg             plane angle
rad         rad             plane angle
arcsec      arcsec          plane angle
deg/s       deg_per_s       angular velocity
rad/s       rad_per_s       angular velocity
rpm         rpm             angular velocity
deg/s^2     deg_per_s2      angular acceleration
rad/s^2     rad_per_s2      angular acceleration
um          um              length
mm          mm              length
cm          cm              length
m           m               length
km          km              length
m^2         m2              area
m/s         m_per_s         velocity
km/s        km_per_s        velocity
m/s^2       m_per_s2        acceleration
ns          ns              time
us          us              time
ms          ms              time
s           s               time
min         min             time
h           h               time
day         day             time
Hz          hz              frequency
kHz         khz             frequency
MHz         mhz             frequency
g           g               mass
kg          kg              mass
N           n               force
mN          mn              force
N.m         n_m             torque
mN.m        mn_m            torque
uN.m        un_m            torque
Nms         nms             angular momentum
mNms        mnms            angular momentum
kg.m^2      kg_m2           moment of inertia
A           a               electric current
mA          ma              electric current
uA          ua              electric current
V           v               voltage
mV          mv              voltage
uV          uv              voltage
W           w               power
mW          mw              power
J           j               energy
Wh          wh              energy
Ah          ah              electric charge
mAh         mah             electric charge
ohm         ohm             resistance
T           t               magnetic flux density
uT          ut              magnetic flux density
nT          nt              magnetic flux density
A.m^2       a_m2            magnetic dipole moment
C           c               temperature (degrees Celsius)
K           k               temperature
Pa          pa              pressure
kPa         kpa             pressure
bar         bar             pressure
%           percent         ratio
ppm         ppm             ratio
dB          db              ratio
dBm         dbm             power level
bit         bit             information
byte        byte            information
bit/s       bit_per_s       data rate
"""


_ROWS = (line.split(None, 2) for line in _TABLE.strip().splitlines())
STANDARD = {
    symbol: Unit(symbol, identifier, quantity) for symbol, identifier, quantity in _ROWS
}

# Other symbols of units in STANDARD that are unambiguous: an importer replaces them.
SIGNS = {
    "°C": "C", "° C": "C", "degC": "C", "deg C": "C", "\u2103": "C", "\u03a9": "ohm", "\u2126": "ohm", "Ohm": "ohm",
    **{micro + unit[1:]: unit for unit in STANDARD if unit.startswith("u") for micro in ("\u00b5", "\u03bc")},
}  # fmt: skip

# Other spellings of units in STANDARD, to suggest the correct symbol.
SPELLINGS = SIGNS | {
    "°": "deg", "degree": "deg", "degrees": "deg", "deg/sec": "deg/s", "RPM": "rpm", "meter": "m", "metre": "m",
    "meters": "m", "seconds": "s", "sec": "s", "milliseconds": "ms", "msec": "ms", "percentage": "%", "percent": "%",
    "Nm": "N.m", "kg.m2": "kg.m^2", "A.m2": "A.m^2",
    "Am2": "A.m^2", "bytes": "byte", "bits": "bit",
    **{unit.replace("^2", "²"): unit for unit in STANDARD if unit.endswith("^2")},
}  # fmt: skip

NOT_STATED = "not stated"
# Replacements of non-ASCII signs in identifiers.
_SIGN_NAMES = str.maketrans(
    {"\u03a9": "ohm", "\u2126": "ohm", "\u00b5": "u", "\u03bc": "u", "°": "deg"}
)
_PREFIXES = frozenset("fpnu\u00b5\u03bcmcdhkMGT")
# Signs of products and powers that are not ASCII.
_OPERATORS = {ord("²"): "^2", ord("³"): "^3", ord("·"): ".", ord("\u22c5"): "."}
# Units that are not built in, but whose symbols are similar to those of other units.
_OTHER_UNITS = frozenset(
    """
    a As atm Ah bps Bq BTU cal cd dBc dBi dBV dBW degF eV F ft G gal Gy H hp in kat kph
    l L lb lbf lm lx mil mol mph Nm Ns Oe oz ppb ppt psi rev rps S Sv t ton var VA Vs Wb
    Ws
    """.split()
)


def similar_unit(symbol: str, declared: Iterable[str]) -> str:
    """Return the standard or declared unit that an unknown symbol probably means.

    Returns an empty string if no unit is similar, or if the similar one measures
    something else or has another size: ``kV`` is no misspelt ``V``, and ``ml/s`` no
    misspelt ``m/s``.
    """
    symbols = {*STANDARD, *declared}
    if symbol in SPELLINGS:
        return SPELLINGS[symbol]
    parts = _parts(symbol)
    plain = "".join(parts)
    # `Nm` and `N.m` are the same product.
    products = {each.replace(".", ""): each for each in symbols if "." in each}
    if plain in symbols or plain in products:
        return products.get(plain, plain)
    units = {part for other in symbols for part in _parts(other)} | _OTHER_UNITS
    # A part that is a unit is not misspelt.
    misspelt = [part for part in parts if not _is_unit(part, units)]
    similar: dict[str, str] = {}
    for other in sorted(symbols):
        candidate = _parts(other)
        if len(candidate) == len(parts) and all(
            part == right or (part in misspelt and close_to(part, [right]))
            for part, right in zip(parts, candidate, strict=True)
        ):
            similar["".join(candidate)] = other
    return similar.get(close_to(plain, similar), "")


@lru_cache(4096)  # an ICD can have thousands of unknown units
def _parts(symbol: str) -> tuple[str, ...]:
    """Return the parts of a symbol: units, operators and exponents, as `STANDARD` writes
    them.
    """
    text = re.sub(r"\s*([./*^-])\s*", r"\1", symbol.strip().translate(_OPERATORS))
    text = re.sub(r"(?<=[A-Za-z])(?=\d+$|\d+[./*])", "^", text.replace("**", "^"))
    text = re.sub(r"[*\s]+", ".", text)
    words = re.findall(r"[^\W\d_]+|\d+|_|\W", text)
    return tuple(SPELLINGS.get(word, word) for word in words)


def _is_unit(part: str, units: set[str]) -> bool:
    """Return whether a part of a symbol is a unit, with or without a prefix."""
    return part in units or (part[:1] in _PREFIXES and part[1:] in units)


def declared(symbols: Iterable[str]) -> list[dict[str, str]]:
    """Return the list `units` of an ICD for symbols that are not standard: each once,
    with a unique identifier.
    """
    units: dict[str, dict[str, str]] = {}
    taken = {unit.identifier for unit in STANDARD.values()}
    for symbol in symbols:
        if symbol in STANDARD or symbol in units:
            continue
        name = (
            "_".join(re.findall("[a-z0-9]+", symbol.translate(_SIGN_NAMES).casefold()))
            or "unit"
        )
        while name in taken:
            name += "_"
        taken.add(name)
        units[symbol] = {"symbol": symbol, "identifier": name, "quantity": NOT_STATED}
    return list(units.values())

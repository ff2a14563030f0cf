"""Units that every ICD may use without declaring them. Device-specific ones are declared in the ICD (`units:`)."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

from icdgen.suggest import close_to


class Unit(NamedTuple):
    """``identifier`` is what generated names end in: ``roll_deg``."""

    symbol: str
    identifier: str
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
STANDARD = {symbol: Unit(symbol, identifier, quantity) for symbol, identifier, quantity in _ROWS}

# Signs for one of the above that mean nothing else: an import writes the unit itself.
SIGNS = {
    "°C": "C", "° C": "C", "degC": "C", "deg C": "C", "\u2103": "C", "\u03a9": "ohm", "\u2126": "ohm", "Ohm": "ohm",
    **{micro + unit[1:]: unit for unit in STANDARD if unit.startswith("u") for micro in ("\u00b5", "\u03bc")},
}  # fmt: skip

# Spellings that mean one of the above; used only to say what the writer probably meant.
SPELLINGS = SIGNS | {
    "°": "deg", "degree": "deg", "degrees": "deg", "deg/sec": "deg/s", "RPM": "rpm", "meter": "m", "metre": "m",
    "meters": "m", "seconds": "s", "sec": "s", "milliseconds": "ms", "msec": "ms", "percentage": "%", "percent": "%",
    "Nm": "N.m", "kg.m2": "kg.m^2", "A.m2": "A.m^2",
    "Am2": "A.m^2", "bytes": "byte", "bits": "bit",
    **{unit.replace("^2", "²"): unit for unit in STANDARD if unit.endswith("^2")},
}  # fmt: skip

NOT_STATED = "not stated"
# What signs are in identifiers.
_SAID = str.maketrans({"\u03a9": "ohm", "\u2126": "ohm", "\u00b5": "u", "\u03bc": "u", "°": "deg"})
_PREFIXES = frozenset("fpnu\u00b5\u03bcmcdhkMGT")


def meant(symbol: str, known: Iterable[str]) -> str:
    """The unit, of those known, that was probably meant. Empty if there is none, as for ``kV``, which is no misspelt ``V``."""
    symbols = {*STANDARD, *known}
    if symbol in SPELLINGS:
        return SPELLINGS[symbol]
    return "" if any(_differ_in_size(symbol, one, symbols) for one in symbols) else close_to(symbol, sorted(symbols))


def _differ_in_size(one: str, other: str, known: set[str]) -> bool:
    """Whether two symbols are those of one unit with different prefixes, in one or more of their parts."""
    parts, others = (re.findall(r"\w+|\W", symbol) for symbol in (one, other))
    if len(parts) != len(others):
        return False
    return all(a == b or _bases(a, known) & _bases(b, known) for a, b in zip(parts, others, strict=True))


def _bases(part: str, known: set[str]) -> set[str]:
    """The known units that a part of a symbol may be, with a prefix or without."""
    return {part, part[1:] if part[0] in _PREFIXES else part} & known


def declared(symbols: Iterable[str]) -> list[dict[str, str]]:
    """What `units:` says of units that are not built in: each symbol once, with an identifier of its own."""
    made: dict[str, dict[str, str]] = {}
    taken = {unit.identifier for unit in STANDARD.values()}
    for symbol in symbols:
        if symbol in STANDARD or symbol in made:
            continue
        name = "_".join(re.findall("[a-z0-9]+", symbol.translate(_SAID).casefold())) or "unit"
        while name in taken:
            name += "_"
        taken.add(name)
        made[symbol] = {"symbol": symbol, "identifier": name, "quantity": NOT_STATED}
    return list(made.values())

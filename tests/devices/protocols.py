"""The protocols whose definitions are converted, and the libraries they are compared
with.
"""

from __future__ import annotations

from tests.devices import can, cygnss, eds, kaitai, mavlink, sbp, sunspec, ubx, xtce
from tests.devices.definition import Protocol

PROTOCOLS = {
    protocol.name: protocol
    for protocol in (
        Protocol("can", "opendbc through cantools", can.databases),
        Protocol("ubx", "pyubx2", ubx.tables),
        Protocol("sbp", "sbp", sbp.tables),
        Protocol("mavlink", "pymavlink", mavlink.dialects),
        Protocol("mavlink1", "pymavlink", mavlink.dialects_of_version_1),
        Protocol("cygnss", "ccsdspy", cygnss.packets),
        Protocol("sunspec", "pysunspec2", sunspec.models),
        Protocol("xtce", "space-packet-parser", xtce.packets),
        Protocol("eds", "an independent bit reader of these tests", eds.sheets),
        Protocol("kaitai", "satnogs-decoders through kaitaistruct", kaitai.satellites),
    )
}

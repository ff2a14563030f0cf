"""The protocols whose definitions are read, and the libraries that judge."""

from __future__ import annotations

from tests.devices import can, cygnss, eds, kaitai, mavlink, sbp, sunspec, ubx, xtce
from tests.devices.definition import Protocol

PROTOCOLS = {
    one.name: one
    for one in (
        Protocol("can", "opendbc through cantools", can.databases),
        Protocol("ubx", "pyubx2", ubx.tables),
        Protocol("sbp", "sbp", sbp.tables),
        Protocol("mavlink", "pymavlink", mavlink.dialects),
        Protocol("mavlink1", "pymavlink", mavlink.dialects_of_version_1),
        Protocol("cygnss", "ccsdspy", cygnss.packets),
        Protocol("sunspec", "pysunspec2", sunspec.models),
        Protocol("xtce", "space-packet-parser", xtce.packets),
        Protocol("eds", "a reader of our own, apart from what is judged", eds.sheets),
        Protocol("kaitai", "satnogs-decoders through kaitaistruct", kaitai.satellites),
    )
}

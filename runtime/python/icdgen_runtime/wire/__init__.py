"""Wire layer: framing, checksums, CAN packets, clients, procedures and logs.

The application passes in received bytes and the time, and takes out bytes to send and
events. No object opens a port, sleeps or reads a clock, except `Session`, over a port
of the application, and `AsyncSession`, over streams. The ``LINK`` of a node describes
its protocol.
"""

from __future__ import annotations

from importlib import import_module

__all__ = [
    "Arrived",
    "AsyncSession",
    "Busy",
    "BusyError",
    "CanEvent",
    "CanJoiner",
    "CanMessage",
    "CanPacket",
    "ChecksumError",
    "Client",
    "Crc",
    "DeviceBusyError",
    "Done",
    "DosTime",
    "Event",
    "FailedError",
    "Gap",
    "I2cTransfer",
    "Identity",
    "IndexEntry",
    "Late",
    "LineError",
    "Link",
    "Log",
    "LogEntry",
    "LogFrame",
    "LogMessage",
    "LogReader",
    "LogWriter",
    "Lost",
    "OutcomeOf",
    "PacketData",
    "Procedure",
    "Progress",
    "Refused",
    "RefusedError",
    "Reply",
    "ReplyTimeoutError",
    "Request",
    "Sender",
    "Sent",
    "Session",
    "Settings",
    "Stray",
    "StreamDecoder",
    "StreamEvent",
    "TelemetryData",
    "Timeout",
    "TooLongError",
    "UartDecoder",
    "UartEvent",
    "UnsupportedError",
    "can_split",
    "checksum",
    "dos_time_pack",
    "dos_time_unpack",
    "i2c_read_length",
    "i2c_reply",
    "i2c_write",
    "identify",
    "read_index",
    "response_to",
    "serial_port",
    "socket_port",
    "stream_encode",
    "stream_encode_packet",
    "stream_encode_request",
    "uart_encode",
    "uart_kind",
    "write_index",
]

# Type checkers treat this name as true. Importing `typing` would slow down the start.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from .async_session import AsyncSession as AsyncSession
    from .awaited import Request as Request
    from .can import CanEvent as CanEvent
    from .can import CanJoiner as CanJoiner
    from .can import CanMessage as CanMessage
    from .can import CanPacket as CanPacket
    from .can import can_split as can_split
    from .checks import checksum as checksum
    from .client import Client as Client
    from .crc import Crc as Crc
    from .device import PacketData as PacketData
    from .device import TelemetryData as TelemetryData
    from .device import response_to as response_to
    from .errors import BusyError as BusyError
    from .errors import ChecksumError as ChecksumError
    from .errors import TooLongError as TooLongError
    from .errors import UnsupportedError as UnsupportedError
    from .events import Arrived as Arrived
    from .events import Busy as Busy
    from .events import Done as Done
    from .events import Event as Event
    from .events import Gap as Gap
    from .events import Late as Late
    from .events import LineError as LineError
    from .events import Log as Log
    from .events import Lost as Lost
    from .events import OutcomeOf as OutcomeOf
    from .events import Progress as Progress
    from .events import Refused as Refused
    from .events import Reply as Reply
    from .events import Sent as Sent
    from .events import Stray as Stray
    from .events import Timeout as Timeout
    from .failures import DeviceBusyError as DeviceBusyError
    from .failures import FailedError as FailedError
    from .failures import RefusedError as RefusedError
    from .failures import ReplyTimeoutError as ReplyTimeoutError
    from .files import IndexEntry as IndexEntry
    from .files import read_index as read_index
    from .files import write_index as write_index
    from .i2c import I2cTransfer as I2cTransfer
    from .i2c import i2c_read_length as i2c_read_length
    from .i2c import i2c_reply as i2c_reply
    from .i2c import i2c_write as i2c_write
    from .identity import Identity as Identity
    from .identity import identify as identify
    from .link import Link as Link
    from .link import Settings as Settings
    from .logs import LogEntry as LogEntry
    from .logs import LogFrame as LogFrame
    from .logs import LogMessage as LogMessage
    from .logs import LogReader as LogReader
    from .logs import LogWriter as LogWriter
    from .ports import serial_port as serial_port
    from .ports import socket_port as socket_port
    from .procedures import Procedure as Procedure
    from .sender import Sender as Sender
    from .session import Session as Session
    from .stream import StreamDecoder as StreamDecoder
    from .stream import StreamEvent as StreamEvent
    from .stream import stream_encode as stream_encode
    from .stream import stream_encode_packet as stream_encode_packet
    from .stream import stream_encode_request as stream_encode_request
    from .times import DosTime as DosTime
    from .times import dos_time_pack as dos_time_pack
    from .times import dos_time_unpack as dos_time_unpack
    from .uart import UartDecoder as UartDecoder
    from .uart import UartEvent as UartEvent
    from .uart import uart_encode as uart_encode
    from .uart import uart_kind as uart_kind

_HOMES = {
    "async_session": ("AsyncSession",),
    "awaited": ("Request",),
    "can": ("CanEvent", "CanJoiner", "CanMessage", "CanPacket", "can_split"),
    "client": ("Client",),
    "checks": ("checksum",),
    "crc": ("Crc",),
    "device": ("PacketData", "TelemetryData", "response_to"),
    "errors": (
        "BusyError",
        "ChecksumError",
        "TooLongError",
        "UnsupportedError",
    ),
    "events": (
        "Arrived",
        "Busy",
        "Done",
        "Event",
        "Gap",
        "Late",
        "LineError",
        "Log",
        "Lost",
        "OutcomeOf",
        "Progress",
        "Refused",
        "Reply",
        "Sent",
        "Stray",
        "Timeout",
    ),
    "failures": ("DeviceBusyError", "FailedError", "RefusedError", "ReplyTimeoutError"),
    "files": ("IndexEntry", "read_index", "write_index"),
    "i2c": ("I2cTransfer", "i2c_read_length", "i2c_reply", "i2c_write"),
    "identity": ("Identity", "identify"),
    "link": ("Link", "Settings"),
    "logs": ("LogEntry", "LogFrame", "LogMessage", "LogReader", "LogWriter"),
    "ports": ("serial_port", "socket_port"),
    "procedures": ("Procedure",),
    "sender": ("Sender",),
    "session": ("Session",),
    "stream": (
        "StreamDecoder",
        "StreamEvent",
        "stream_encode",
        "stream_encode_packet",
        "stream_encode_request",
    ),
    "times": ("DosTime", "dos_time_pack", "dos_time_unpack"),
    "uart": ("UartDecoder", "UartEvent", "uart_encode", "uart_kind"),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}


if not TYPE_CHECKING:

    def __getattr__(name):
        if name not in _HOME:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = getattr(import_module(f".{_HOME[name]}", __name__), name)
        globals()[name] = value
        return value

    def __dir__():
        return sorted({*globals(), *__all__})

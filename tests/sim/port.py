"""A byte port to the simulated device, with simulated time."""

from __future__ import annotations

from icdgen_runtime.wire.uart import uart_encode

from icdgen.icd.model import Icd
from icdgen.sim import run


class DevicePort:
    """Port without sleeping: reading advances the clock ``now``, in milliseconds."""

    def __init__(self, icd: Icd, node: str, **options) -> None:
        self.line, _ = run.build_device(icd, node, run.Options(**options))
        self.now = 0.0

    def clock(self) -> float:
        return self.now / 1000

    def write(self, data: bytes) -> None:
        self.line.received(int(self.now), data)

    def read(self, seconds: float) -> bytes:
        end = self.now + seconds * 1000
        while True:
            data = self.line.take(int(self.now))
            due = self.line.deadline
            if data or self.now >= end:
                return data
            self.now = end if due is None else min(end, max(self.now + 1, due))
            self.line.tick(int(self.now))

    def close(self) -> None:
        pass


class Refusing(DevicePort):
    """Port whose acknowledges of the telecommand have the error code a number of times.
    ``acknowledged`` counts them.
    """

    def __init__(
        self, icd: Icd, node: str, id: int, code: int, times: int, **options
    ) -> None:
        super().__init__(icd, node, **options)
        link = self.line.computer.program.link
        self.good, self.bad = (
            uart_encode(link, bytes((id, code_))) for code_ in (0, code)
        )
        self.times, self.acknowledged = times, 0

    def read(self, seconds: float) -> bytes:
        data = super().read(seconds)
        if self.good in data:
            self.acknowledged += 1
            if self.acknowledged <= self.times:
                return data.replace(self.good, self.bad)
        return data

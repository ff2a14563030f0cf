"""Mistakes that a type checker must report, one on each line with ``# expect``."""

from __future__ import annotations

import asyncio

from icdgen_messages import bootloader, cubeacp
from icdgen_messages.cubeacp import LINK, EstimatedAttitudeAngles
from icdgen_messages.wire import AsyncSession, Client, Done, Session

angles = EstimatedAttitudeAngles()
angles.roll = 1  # expect
angles.estimated_roll_angle = "1"  # expect
EstimatedAttitudeAngles(estimated_roll_angle=b"1")  # expect
EstimatedAttitudeAngles.from_bytes("2efb")  # expect
EstimatedAttitudeAngles.from_physical(estimated_roll_angle_deg="1")  # expect
print(cubeacp.Nonsense)  # expect
EstimatedAttitudeAngles(1)  # expect
EstimatedAttitudeAngles(estimated_roll_angle_deg="1")  # expect
EstimatedAttitudeAngles(roll=1)  # expect
EstimatedAttitudeAngles(estimated_roll_angle_mdeg=1)  # expect
angles.estimated_roll_angle_mdeg = 0.5  # expect
text: str = angles.estimated_roll_angle_deg  # expect
Client(LINK, "spi")  # expect
Client(LINK, "uart").request(0, angles)  # expect
Client(LINK, "uart").received(0, "1f7f")  # expect
outcome = Session(LINK, print, lambda s: b"").ask(EstimatedAttitudeAngles)
if isinstance(outcome, Done):
    print(outcome.message.roll)  # expect
for event in Client(LINK, "uart").received(0, b""):
    if isinstance(event, Done) and (frame := event.of(EstimatedAttitudeAngles)):
        print(frame.roll)  # expect
number: int = Session(LINK, print, lambda s: b"").get(EstimatedAttitudeAngles)  # expect
session = Session(LINK, print, lambda s: b"")
session.send(bootloader.SetBootIndex())  # expect
session.get(bootloader.State)  # expect
session.ask(bootloader.State)  # expect
Client(LINK, "uart").send(0, bootloader.SetBootIndex())  # expect
Client(LINK, "uart").request(0, bootloader.State)  # expect


async def of_another_node(
    reader: asyncio.StreamReader, writer: asyncio.StreamWriter
) -> None:
    """What asyncio's session is not given either."""
    session = AsyncSession(LINK, reader, writer)
    await session.send(bootloader.SetBootIndex())  # expect
    await session.get(bootloader.State)  # expect

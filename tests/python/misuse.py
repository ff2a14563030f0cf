"""What a type checker must find. One mistake a line."""

from __future__ import annotations

from icdgen_messages import cubeacp
from icdgen_messages.cubeacp import LINK, EstimatedAttitudeAngles
from icdgen_messages.wire import Client, Done, Session

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

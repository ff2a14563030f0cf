"""What a type checker must find. One mistake a line."""

from __future__ import annotations

from icdgen_messages import cubeacp
from icdgen_messages.cubeacp import EstimatedAttitudeAngles

angles = EstimatedAttitudeAngles()
angles.roll = 1  # expect
angles.estimated_roll_angle = "1"  # expect
EstimatedAttitudeAngles(estimated_roll_angle=b"1")  # expect
EstimatedAttitudeAngles.from_bytes("2efb")  # expect
EstimatedAttitudeAngles.from_physical(estimated_roll_angle=1)  # expect
print(cubeacp.Nonsense)  # expect
text: str = angles.estimated_roll_angle_deg  # expect

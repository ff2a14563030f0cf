"""Decodes a frame of telemetry 146, given as hex, with the package that icdgen makes."""

import sys

from icdgen_messages import IcdError
from icdgen_messages.cubeacp import EstimatedAttitudeAngles

try:
    angles = EstimatedAttitudeAngles.from_bytes(bytes.fromhex(sys.argv[1]))
except IcdError as error:
    sys.exit(str(error))
print(
    f"roll  {angles.estimated_roll_angle:7d}  {angles.estimated_roll_angle_deg:8.2f} deg"
)
print(
    f"pitch {angles.estimated_pitch_angle:7d}  {angles.estimated_pitch_angle_deg:8.2f} deg"
)
print(
    f"yaw   {angles.estimated_yaw_angle:7d}  {angles.estimated_yaw_angle_deg:8.2f} deg"
)

"""Switches the loop of a node on and asks for its attitude.

In another terminal: icdgen sim --node cubeacp --tcp 4000
"""

import socket

from icdgen_messages.cubeacp import (
    LINK,
    AdcsRunMode,
    EstimatedAttitudeAngles,
    SetAdcsRunMode,
)
from icdgen_messages.wire import Session

with socket.create_connection(("127.0.0.1", 4000)) as port:
    device = Session(
        LINK, port
    )  # or a serial port of pyserial, a CAN bus of python-can, an I2C bus of smbus2
    device.send(
        SetAdcsRunMode(enabled=AdcsRunMode.ENABLED)
    )  # returns when it is acknowledged
    angles = device.get(EstimatedAttitudeAngles)
    print(f"roll {angles.estimated_roll_angle_deg:.2f} deg")

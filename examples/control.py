"""Sends two telecommands, reads two messages, and prints errors.

In another terminal: icdgen sim --node cubeacp --tcp 4000
"""

import socket
import sys

from icdgen_messages import IcdError
from icdgen_messages.cubeacp import (
    LINK,
    CommandedAttitudeAngles,
    CurrentAdcsState,
    EstimatedAttitudeAngles,
    EstimModeSelect,
    SetWheelSpeed,
)
from icdgen_messages.wire import RefusedError, ReplyTimeoutError, Session


def control(device: Session) -> None:
    device.send(
        SetWheelSpeed(commanded_x_speed=100)
    )  # a field without a formula: its raw value is in rpm
    device.send(
        CommandedAttitudeAngles(commanded_roll_angle_deg=1.5)
    )  # RangeError if it did not fit the field

    angles = device.get(EstimatedAttitudeAngles)
    print(f"roll {angles.estimated_roll_angle_deg:.2f} deg")

    mode = device.get(
        CurrentAdcsState
    ).attitude_estimation_mode  # an IntEnum that keeps what it does not know
    if mode is EstimModeSelect.NO_ATTITUDE_ESTIMATION:
        print("nothing is estimated")
    else:
        print(
            f"estimated by {mode.label}"
            if mode.label
            else f"estimation mode {int(mode)} has no name"
        )


def main(place: str) -> None:
    try:
        with socket.create_connection(("127.0.0.1", int(place))) as port:
            control(Session(LINK, port))
    except (
        RefusedError
    ) as error:  # error.event has the code, and as `reason` its name in the ICD
        sys.exit(f"refused, code {error.event.code}")
    except ReplyTimeoutError as error:
        sys.exit(f"no response, attempts: {error.event.attempts}")
    except (
        IcdError,
        OSError,
    ) as error:  # what cannot be sent or read; what the port says
        sys.exit(str(error))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "4000")

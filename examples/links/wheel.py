"""Commands the reaction wheel of wheel.yaml, which acknowledges or refuses each
telecommand.

In another terminal: icdgen sim --icd examples/links/wheel.yaml --tcp 4000

    icdgen --lang python --out build/wheel examples/links/wheel.yaml
    PYTHONPATH=build/wheel python examples/links/wheel.py 4000
"""

import socket
import sys

from icdgen_messages import IcdError
from icdgen_messages.wheel import LINK, Events, Mode, SetMode, SetSpeed
from icdgen_messages.wire import (
    DeviceBusyError,
    RefusedError,
    ReplyTimeoutError,
    Session,
)


def command(wheel: Session) -> None:
    # Each line returns when the wheel has acknowledged.
    wheel.send(SetMode(mode=Mode.SPEED))
    wheel.send(SetSpeed(speed_rpm=1500.0))
    print(f"{wheel.get(Events).count} events")


def main(place: str) -> None:
    try:
        with socket.create_connection(("127.0.0.1", int(place))) as port:
            command(Session(LINK, port))
    except RefusedError as error:
        sys.exit(f"refused: {error.event.reason}")
    except DeviceBusyError as error:  # also at the last attempt
        sys.exit(f"busy, attempts: {error.event.attempts}")
    except ReplyTimeoutError as error:  # it is not known whether it was executed
        sys.exit(f"no response, attempts: {error.event.attempts}")
    except (IcdError, OSError) as error:  # what cannot be sent; what the port says
        sys.exit(str(error))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "4000")

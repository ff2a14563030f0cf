"""Program of a user of the package. Type checkers check it; no test runs it."""

from __future__ import annotations

from icdgen_messages import FieldInfo, IcdError, LengthError, Message, OpenEnum, cubeacp
from icdgen_messages.common import Reset
from icdgen_messages.cubeacp import (
    AdcsState,
    ConModeSelect,
    CurrentAdcsState,
    EstimatedAttitudeAngles,
    FileType,
    decode_telecommand,
    decode_telemetry,
)
from icdgen_messages.cubeacp.procedures import Download, List
from icdgen_messages.cubewheel import *  # noqa: F403
from icdgen_messages.wire import (
    AsyncSession,
    Client,
    Done,
    Event,
    Refused,
    Session,
    UartDecoder,
)


def roll(id: int, data: bytes) -> float:
    """The roll angle in degrees, if the frame has one."""
    try:
        message: Message = decode_telemetry(id, data)
    except LengthError as error:
        return float(error.expected - error.actual)
    except IcdError:
        return 0.0
    if isinstance(message, EstimatedAttitudeAngles):
        return message.estimated_roll_angle_deg
    return 0.0


def commands() -> list[bytes]:
    """Frames of some telecommands."""
    angles = EstimatedAttitudeAngles.from_bytes(memoryview(bytes(6)))
    angles.estimated_roll_angle_deg = 3
    angles.estimated_pitch_angle = 5
    level = EstimatedAttitudeAngles.from_physical(estimated_roll_angle_deg=1.5)
    state = CurrentAdcsState(control_mode=ConModeSelect(3), cubesense1_enabled=True)
    mode: OpenEnum = state.control_mode
    number: int = (
        state.control_mode.value + state.control_mode + cubeacp.CurrentAdcsState.ID
    )
    label: str = mode.label
    field: FieldInfo = CurrentAdcsState.FIELDS[number]
    print(
        label, field.unit, field.scale, state.as_dict(physical=True), AdcsState.LENGTH
    )
    return [
        angles.to_bytes(),
        level.to_bytes(),
        Reset().to_bytes(),
        decode_telecommand(1, b"\x5a").to_bytes(),
    ]


def wheel_speed_of(data: bytes) -> float:
    """Speed of a wheel. The class comes from a star import."""
    return WheelSpeed.from_bytes(data).wheel_speed  # noqa: F405


def columns(data: bytes) -> float:
    """The mean of a column."""
    return float(
        EstimatedAttitudeAngles.decode_many(data, physical=True)[
            "estimated_roll_angle_deg"
        ].mean()
    )


def send_any(session: Session, any: type[Message]) -> Message:
    """Send and request messages in sessions with and without a known node.

    A session of an unknown node accepts all messages. The session of a node accepts its
    messages, those it includes, and messages whose class is not known to the checker.
    """
    session.send(Reset())
    own = Session(cubeacp.LINK, print, lambda seconds: b"")
    own.send(Reset())
    own.get(any)
    return own.get(EstimatedAttitudeAngles)


def talk(client: Client, now: float, data: bytes) -> list[str]:
    """Send a request with a client, and handle its outcome."""
    client.request(now, EstimatedAttitudeAngles)
    print(client.output(), client.deadline)
    events: list[Event] = client.received(now, data)
    results = []
    for event in events:
        if isinstance(event, Done) and (angles := event.of(EstimatedAttitudeAngles)):
            results.append(f"{angles.estimated_roll_angle_deg}")
        elif isinstance(event, Refused):
            results.append(event.reason or "unknown")
    return results


def wait(session: Session) -> tuple[float, bytes]:
    """Request a message of a static type, and download a file."""
    session.send(Reset())
    decoder = UartDecoder(cubeacp.LINK)
    print([event.event for event in decoder.feed(b"")], cubeacp.LINK.assumptions[0].why)
    download = session.run(Download(FileType.TELEMETRY_LOG, 0, 100))
    return session.get(EstimatedAttitudeAngles).estimated_roll_angle_deg, download.data


def sizes(session: Session) -> list[int]:
    """The sizes of all files."""
    return [entry.file_size for entry in session.run(List()).entries]


def ask(session: Session) -> float:
    """Handle the outcome of a request without an exception."""
    outcome = session.ask(EstimatedAttitudeAngles)
    return (
        outcome.message.estimated_roll_angle_deg if isinstance(outcome, Done) else 0.0
    )


async def wait_async(session: AsyncSession) -> tuple[float, float, bytes]:
    """Request a message and download a file in an asyncio session."""
    await session.send(Reset())
    outcome = await session.ask(EstimatedAttitudeAngles)
    angle = (
        outcome.message.estimated_roll_angle_deg if isinstance(outcome, Done) else 0.0
    )
    download = await session.run(Download(FileType.TELEMETRY_LOG, 0, 100))
    return (
        (await session.get(EstimatedAttitudeAngles)).estimated_roll_angle_deg,
        angle,
        download.data,
    )


def from_json_or_physical(text: str) -> EstimatedAttitudeAngles:
    """Create a message from physical values, or from JSON."""
    angles = EstimatedAttitudeAngles(
        estimated_roll_angle_deg=1.5, estimated_pitch_angle=3
    )
    return EstimatedAttitudeAngles.from_json(text or angles.to_json(physical=True))

"""What stands on the page about the API, between [key] and []: it is run by a test."""

from icdgen_messages import RangeError, imu, is_special
from icdgen_messages.imu import LINK, Attitude, Climate, Mode, Setup, State
from icdgen_messages.wire import Client, Done, Event

frame = bytes.fromhex("2efb0a00d700fbff494d550011526400")
now = 0

# [new]
setup = Setup()
# []
assert setup.rate == 0
# [decode]
state = State.from_bytes(frame)
# []
assert state.pitch == 10
# [encode]
written = state.to_bytes()
# []
assert written == frame
setup.timeout = 4096
try:
    # [valid]
    setup.to_bytes()  # RangeError, with the name of the field
    # []
except RangeError as error:
    text = error.field
assert text == "timeout"
setup.timeout = 0
# [name]
text = State.NAME
# []
assert text == "State"
# [ids]
ids = Setup.SET_ID, Setup.GET_ID, State.ID
# []
assert ids == (20, 132, 131)
# [length]
length = State.LENGTH
# []
assert length == 16
# [dispatch]
any = imu.decode_telemetry(131, frame)
# []
assert any == state
# [part]
attitude = Attitude.from_part(state)
# []
assert attitude == Attitude(roll=-1234, pitch=10)

# [get]
raw = state.roll
# []
assert raw == -1234
# [set]
state.pitch = 20
# []
assert state.pitch == 20
# [physical]
value = state.roll_deg
# []
assert value == -12.34
# [set_physical]
state.roll_deg = 12.5
# []
assert state.roll == 1250
# [exact]
thousandths = state.roll_mdeg
# []
assert thousandths == 12500
# [set_exact]
state.roll_mdeg = -12340
# []
assert state.roll == -1234
# [enum]
holds = state.mode == Mode.ACTIVE
# []
assert holds
# [set_enum]
state.mode = Mode.IDLE
# []
assert state.mode == 0
# [enum_name]
text = state.mode.label
# []
assert text == "Idle"
# [flag]
holds = state.valid
# []
assert holds
# [divided]
raw = state.slow_period
# []
assert raw == 5 and state.fast_period == 2
# [array]
raw = state.heat[1]
# []
assert raw == -5
# [array_physical]
value = state.heat_c[1]
# []
assert value == -0.5
# [set_array]
state.heat_c = (21.5, 30.0)
# []
assert state.heat == (215, 300)
# [text]
text = state.label_text
# []
assert text == "IMU"
# [set_text]
state.label_text = "AHRS"
# []
assert state.label == b"AHRS"
# [view]
raw = state.status
# []
assert raw == 0x10

# [fields]
fields = Setup.FIELDS
# []
assert len(fields) == 2
# [field_name]
text = fields[0].name
# []
assert text == "Rate"
# [unit]
unit = fields[0].unit
# []
assert unit == "Hz"
# [place]
place = fields[0].at + fields[0].bits
# []
assert place == 16
# [limits]
limit = fields[0].maximum
# []
assert limit == 400
# [allows]
holds = fields[0].allows(400.5)
# []
assert (
    not holds
    and fields[0].allows(400.0)
    and not fields[0].allows(0.5)
    and fields[1].allows(1e9)
)
# [limit]
limit = Setup.RATE_HZ_MAX
# []
assert limit == 400
# [special]
setup.timeout = Setup.TIMEOUT_NEVER
# []
assert setup.timeout == 4095
climate = Climate()
assert not is_special(climate.pressure, Climate.PRESSURE_NOT_KNOWN)
climate.pressure = Climate.PRESSURE_NOT_KNOWN
# [nan]
holds = is_special(climate.pressure, Climate.PRESSURE_NOT_KNOWN)
# []
assert holds

# [client]
client = Client(LINK, "uart")
# []
events: list[Event] = []
# [request]
client.request(now, State)
# []
# [output]
sent = client.output()
# []
assert len(sent) == 5
received = bytes.fromhex("100283") + frame + bytes.fromhex("1003")
# [received]
events += client.received(now, received)
# []
came = None
for event in events:
    # [receive]
    if isinstance(event, Done):
        came = event.of(State)
    # []
assert came == State.from_bytes(frame)
# [send]
client.send(now, setup)
# []

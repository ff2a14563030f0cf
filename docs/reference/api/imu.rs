//! What stands on the page about the API, between [key] and []: it is built and run by a test.

use icd::imu::{enums::Mode, Attitude, Climate, Setup, State, Telemetry, LINK, LONGEST};
use icd::wire::{uart, Client};
use icd::{is_special, Message};

const FRAME: [u8; 16] = *b"\x2e\xfb\x0a\x00\xd7\x00\xfb\xffIMU\x00\x11\x52\x64\x00";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let now = 0;
    // [new]
    let mut setup = Setup::default();
    // []
    assert_eq!(setup.rate, 0);
    // [decode]
    let mut state = State::from_bytes(&FRAME)?;
    // []
    assert_eq!(state.pitch, 10);
    // [encode]
    let written = state.to_bytes()?;
    // []
    assert_eq!(written, FRAME);
    setup.timeout = 4096;
    // [valid]
    let error = setup.to_bytes().unwrap_err();
    // []
    assert_eq!(error.to_string(), "`Timeout` takes 0 to 4095 s");
    setup.timeout = 0;
    // [name]
    let text = State::NAME;
    // []
    assert_eq!(text, "State");
    // [ids]
    let ids = [Setup::SET_ID, Setup::GET_ID, State::ID];
    // []
    assert_eq!(ids, [20, 132, 131]);
    // [length]
    let length = State::LENGTH;
    // []
    assert_eq!(length, 16);
    // [dispatch]
    let any = Telemetry::from_bytes(131, &FRAME)?;
    // []
    assert_eq!(any, Telemetry::State(state));
    // [part]
    let attitude = Attitude::from(&state);
    // []
    assert_eq!((attitude.roll, attitude.pitch), (-1234, 10));

    // [get]
    let raw = state.roll;
    // []
    assert_eq!(raw, -1234);
    // [set]
    state.pitch = 20;
    // []
    assert_eq!(state.pitch, 20);
    // [physical]
    let value = state.roll_deg();
    // []
    assert_eq!(value, -12.34);
    // [set_physical]
    state.set_roll_deg(12.5)?;
    // []
    assert_eq!(state.roll, 1250);
    // [exact]
    let thousandths = state.roll_mdeg();
    // []
    assert_eq!(thousandths, 12500);
    // [set_exact]
    state.set_roll_mdeg(-12340)?;
    // []
    assert_eq!(state.roll, -1234);
    // [single]
    let value = state.roll_deg_f32();
    // []
    assert_eq!(value, -12.34);
    // [enum]
    let holds = state.mode == Mode::Active;
    // []
    assert!(holds);
    // [set_enum]
    state.mode = Mode::Idle.into();
    // []
    assert_eq!(state.mode.raw(), 0);
    // [enum_name]
    let text = state.mode.name();
    // []
    assert_eq!(text, Some("Idle"));
    // [flag]
    let holds = state.valid;
    // []
    assert!(holds);
    // [divided]
    let raw = state.slow_period;
    // []
    assert_eq!((raw, state.fast_period), (5, 2));
    // [array]
    let raw = state.heat[1];
    // []
    assert_eq!(raw, -5);
    // [array_physical]
    let value = state.heat_c(1);
    // []
    assert_eq!(value, Some(-0.5));
    // [set_array]
    state.set_heat_c(1, 30.0)?;
    // []
    assert_eq!(state.heat, [215, 300]);
    // [text]
    let text = state.label_text();
    // []
    assert_eq!(text, Some("IMU"));
    // [set_text]
    state.set_label_text("AHRS")?;
    // []
    assert_eq!(&state.label, b"AHRS");
    // [view]
    let raw = state.status();
    // []
    assert_eq!(raw, 0x10);

    // [fields]
    let fields = Setup::FIELDS;
    // []
    assert_eq!(fields.len(), 2);
    // [field_name]
    let text = fields[0].name;
    // []
    assert_eq!(text, "Rate");
    // [unit]
    let unit = fields[0].unit;
    // []
    assert_eq!(unit, "Hz");
    // [place]
    let place = fields[0].at + fields[0].bits;
    // []
    assert_eq!(place, 16);
    // [limits]
    let limit = fields[0].limits[1];
    // []
    assert_eq!(limit, ("max", 400.0));
    // [allows]
    let holds = fields[0].allows(400.5);
    // []
    assert!(!holds && fields[0].allows(400.0) && !fields[0].allows(0.5) && fields[1].allows(1e9));
    // [limit]
    let limit = Setup::RATE_HZ_MAX;
    // []
    assert_eq!(f64::from(limit), 400.0);
    // [special]
    setup.timeout = Setup::TIMEOUT_NEVER;
    // []
    assert_eq!(setup.timeout, 4095);
    let mut climate = Climate::default();
    assert!(!is_special(climate.pressure, Climate::PRESSURE_NOT_KNOWN));
    climate.pressure = Climate::PRESSURE_NOT_KNOWN;
    // [nan]
    let holds = is_special(climate.pressure, Climate::PRESSURE_NOT_KNOWN);
    // []
    assert!(holds);

    // [client]
    let mut client = Client::<_, uart::Line<LONGEST>, 1>::uart(&LINK)?;
    // []
    // [request]
    client.request::<State>(now)?;
    // []
    let (mut sent, mut line) = (Vec::new(), [0; 2 * LONGEST + 4]);
    // [output]
    while let Some(bytes) = client.output(&mut line)? {
        sent.extend_from_slice(bytes);
    }
    // []
    assert_eq!(sent.len(), 5);
    let received = [&[0x10, 0x02, 0x83], &FRAME[..], &[0x10, 0x03]].concat();
    let mut came = None;
    // [received]
    client.received(now, &received, |event| {
        // [receive]
        if let Some(state) = event.message::<State>() {
            came = Some(state);
        }
        // []
    });
    // []
    assert_eq!(came, Some(State::from_bytes(&FRAME)?));
    // [send]
    client.send(now, &setup)?;
    // []
    Ok(())
}

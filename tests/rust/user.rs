//! Uses the generated crate as a flight program would; any surprise is a panic.

use icd::common::Reset;
use icd::cubeacp::enums::{ConModeSelect, EstimModeSelect};
use icd::cubeacp::{AdcsConfiguration, CurrentAdcsState, EstimatedAttitudeAngles, SetAttitudeControlMode, Telecommand, Telemetry};
use icd::{Coded, Error};

fn main() {
    reading();
    writing();
    enumerations();
    dispatching();
    floats();
}

fn reading() {
    let mut angles = EstimatedAttitudeAngles::from_bytes(&[0x2e, 0xfb, 0x0a, 0, 0, 0]).unwrap();
    assert_eq!(angles.estimated_roll_angle, -1234);
    assert_eq!(angles.estimated_roll_angle_deg().to_bits(), (-12.34_f64).to_bits());
    assert_eq!(angles.set_estimated_yaw_angle_deg(0.005), Ok(()));
    assert_eq!(angles.estimated_yaw_angle, 1, "0.005 is a little more than the tie");
    assert_eq!(angles.set_estimated_yaw_angle_deg(0.025), Ok(()));
    assert_eq!(angles.estimated_yaw_angle, 3, "0.025 is a little more than the tie, too");
    for refused in [f64::NAN, f64::INFINITY, -f64::INFINITY, 327.68, -327.69, f64::MAX] {
        let error = angles.set_estimated_yaw_angle_deg(refused).unwrap_err();
        assert_eq!(error, Error::Range { field: "Estimated Yaw Angle" });
        assert_eq!(angles.estimated_yaw_angle, 3);
    }
    for length in [0, 5, 7, 512] {
        let error = EstimatedAttitudeAngles::from_bytes(&vec![0; length]).unwrap_err();
        assert_eq!(error, Error::Length { expected: 6, actual: length });
        assert_eq!(error.to_string(), format!("6 bytes expected, {} given", length));
    }
    assert_eq!(EstimatedAttitudeAngles::from_array(&angles.to_bytes()), angles);
}

fn writing() {
    assert_eq!(Reset::default().to_bytes(), [Reset::MAGIC_NUMBER_CONST]);
    let command = SetAttitudeControlMode {
        control_mode: ConModeSelect::from(3).into(),
        timeout: SetAttitudeControlMode::TIMEOUT_NO_TIMEOUT,
    };
    assert_eq!(command.to_bytes(), [3, 0xff, 0xff]);
    assert_eq!(SetAttitudeControlMode::LENGTH, 3);
    let mut state = CurrentAdcsState::default();
    assert_eq!((state.to_bytes(), state.try_to_bytes()), ([0; 6], Ok([0; 6])));
    state.control_mode = Coded::from_raw(0x1e);
    assert_eq!(state.to_bytes(), [0xe0, 0, 0, 0, 0, 0], "what does not fit touches no other field");
    assert_eq!(state.try_to_bytes(), Err(Error::Range { field: "Control Mode" }));
}

fn enumerations() {
    let mut frame = [0; 6];
    frame[0] = 0xe2;
    let state = CurrentAdcsState::from_bytes(&frame).unwrap();
    match state.control_mode.get() {
        ConModeSelect::Unknown(raw) => assert_eq!(raw, 14),
        known => assert_eq!(u8::from(known), 14),
    }
    let estimation = EstimModeSelect::from(2);
    assert_eq!(state.attitude_estimation_mode, estimation);
    assert_eq!(state.attitude_estimation_mode.name(), estimation.name());
    assert_eq!(format!("{:?}", state.attitude_estimation_mode), format!("{:?}", estimation));
    for raw in 0..=255 {
        assert_eq!(ConModeSelect::from(raw).raw(), raw);
        assert_eq!(Coded::<ConModeSelect>::from(ConModeSelect::Unknown(raw)), Coded::from_raw(raw));
    }
}

fn dispatching() {
    let mut buffer = [0xaa; 8];
    match Telemetry::from_bytes(146, &[1, 0, 2, 0, 3, 0]) {
        Ok(Telemetry::EstimatedAttitudeAngles(angles)) => assert_eq!(angles.estimated_yaw_angle, 3),
        other => panic!("{:?}", other),
    }
    let command = Telecommand::from_bytes(1, &[90]).unwrap();
    assert_eq!((command.id(), command.length(), command.name()), (Reset::ID, 1, Reset::NAME));
    assert_eq!(command.write_to(&mut buffer), Ok(1));
    assert_eq!(buffer[..2], [90, 0xaa]);
    assert_eq!(command.write_to(&mut []), Err(Error::Length { expected: 1, actual: 0 }));
    assert_eq!(Telemetry::from_bytes(255, &[]), Err(Error::UnknownId { id: 255 }));
    let (set, get) = (AdcsConfiguration::SET_ID, AdcsConfiguration::GET_ID);
    assert!(matches!(Telecommand::from_bytes(set, &[0; 504]), Ok(Telecommand::AdcsConfiguration(_))));
    assert!(matches!(Telemetry::from_bytes(get, &[0; 504]), Ok(Telemetry::AdcsConfiguration(_))));
}

fn floats() {
    let frame = [0x01, 0x00, 0xf0, 0x7f].repeat(126);
    let configuration = AdcsConfiguration::from_bytes(&frame).unwrap();
    let encoded = configuration.to_bytes();
    let again = AdcsConfiguration::from_bytes(&encoded).unwrap();
    assert_eq!(again.to_bytes(), encoded, "signalling NaNs are kept");
}

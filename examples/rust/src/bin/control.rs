//! Sends two telecommands, reads two messages, and prints errors. In another terminal:
//! icdgen sim --node cubeacp --tcp 4000
use icd::cubeacp::{
    enums::EstimModeSelect, CommandedAttitudeAngles, CurrentAdcsState, EstimatedAttitudeAngles,
    Node, SetWheelSpeed, LINK, LONGEST,
};
use icd::wire::{uart, Failure, Session};
use std::{env, net::TcpStream, process::ExitCode, time::Duration};

fn control(device: &mut Session<Node, TcpStream, uart::Line<LONGEST>>) -> Result<(), Failure> {
    device.send(&SetWheelSpeed {
        commanded_x_speed: 100, // a field without a formula: its raw value is in rpm
        ..SetWheelSpeed::default()
    })?;
    let mut commanded = CommandedAttitudeAngles::default();
    commanded.set_commanded_roll_angle_deg(1.5)?; // Error::Range if it did not fit the field
    device.send(&commanded)?;

    let angles = device.get::<EstimatedAttitudeAngles>()?;
    println!("roll {:.2} deg", angles.estimated_roll_angle_deg());

    // The mode can be a value that the ICD does not name.
    let mode = device.get::<CurrentAdcsState>()?.attitude_estimation_mode;
    match mode.get() {
        EstimModeSelect::NoAttitudeEstimation => println!("nothing is estimated"),
        EstimModeSelect::Unknown(number) => println!("estimation mode {number} has no name"),
        known => println!("estimated by {known}"),
    }
    Ok(())
}

fn run(place: &str) -> Result<(), Failure> {
    let port = TcpStream::connect(format!("127.0.0.1:{place}"))?;
    port.set_read_timeout(Some(Duration::from_millis(10)))?;
    control(&mut Session::uart(&LINK, port)?)
}

fn main() -> ExitCode {
    let place = env::args().nth(1).unwrap_or_else(|| "4000".into());
    match run(&place) {
        Ok(()) => return ExitCode::SUCCESS,
        // `Failure::reason` gives the code as a value of its enumeration.
        Err(Failure::Refused { code, .. }) => eprintln!("refused, code {}", code.unwrap_or(0)),
        Err(Failure::Timeout { attempts, .. }) => eprintln!("no response, attempts: {attempts}"),
        Err(Failure::Port(error)) => eprintln!("{error}"),
        Err(other) => eprintln!("{other}"), // what cannot be sent or read
    }
    ExitCode::FAILURE
}

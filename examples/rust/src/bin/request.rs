//! Switches the loop of a node on and asks for its attitude. In another terminal: icdgen sim --node cubeacp --tcp 4000
use icd::cubeacp::{enums::AdcsRunMode, EstimatedAttitudeAngles, SetAdcsRunMode, LINK, LONGEST};
use icd::wire::{uart, Session};
use std::{error::Error, net::TcpStream, time::Duration};

fn main() -> Result<(), Box<dyn Error>> {
    let port = TcpStream::connect("127.0.0.1:4000")?; // or a serial port: what reads and writes
    port.set_read_timeout(Some(Duration::from_millis(10)))?; // between reads the clock is looked at
    let mut device = Session::<_, _, uart::Line<LONGEST>>::uart(&LINK, port)?;
    let enabled = AdcsRunMode::Enabled.into();
    device.send(&SetAdcsRunMode { enabled })?; // returns when it is acknowledged
    let angles = device.get::<EstimatedAttitudeAngles>()?;
    println!("roll {} deg", angles.estimated_roll_angle_deg());
    Ok(())
}

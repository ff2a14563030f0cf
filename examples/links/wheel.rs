//! Commands the reaction wheel of wheel.yaml, which acknowledges or refuses each telecommand. In
//! another terminal: icdgen sim --icd examples/links/wheel.yaml --tcp 4000
//!
//! `icdgen --lang rust --out build/wheel examples/links/wheel.yaml` writes the crate `icd`; this
//! program needs its feature `std`.
use icd::wheel::{enums::Mode, Events, Node, SetMode, SetSpeed, LINK, LONGEST, SEQUENCES};
use icd::wire::{stream, Failure, Session};
use std::{env, net::TcpStream, process::ExitCode, time::Duration};

type Wheel = Session<Node, TcpStream, stream::Line<LONGEST, SEQUENCES>>;

fn command(wheel: &mut Wheel) -> Result<(), Failure> {
    // Each line returns when the wheel has acknowledged.
    wheel.send(&SetMode {
        mode: Mode::Speed.into(),
    })?;
    let mut speed = SetSpeed::default();
    speed.set_speed_rpm(1500.0)?; // Error::Range if it did not fit the field
    wheel.send(&speed)?;
    println!("{} events", wheel.get::<Events>()?.count);
    Ok(())
}

fn run(place: &str) -> Result<(), Failure> {
    let port = TcpStream::connect(format!("127.0.0.1:{place}"))?;
    port.set_read_timeout(Some(Duration::from_millis(10)))?; // between reads the clock is looked at
    command(&mut Session::new(&LINK, port)?)
}

fn main() -> ExitCode {
    let place = env::args().nth(1).unwrap_or_else(|| "4000".into());
    let failure = match run(&place) {
        Ok(()) => return ExitCode::SUCCESS,
        Err(failure) => failure,
    };
    match (failure.reason::<Node>(), failure) {
        (Some(reason), _) => eprintln!("refused: {reason}"),
        (_, Failure::Busy { attempts, .. }) => eprintln!("busy, attempts: {attempts}"),
        // It is not known whether it was executed.
        (_, Failure::Timeout { attempts, .. }) => eprintln!("no response, attempts: {attempts}"),
        (_, other) => eprintln!("{other}"), // what cannot be sent; what the port says
    }
    ExitCode::FAILURE
}

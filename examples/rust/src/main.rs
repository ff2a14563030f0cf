//! Decodes a frame of telemetry 146, given as hex, with the crate that icdgen makes.

use icd::cubeacp::EstimatedAttitudeAngles;

fn bytes_of(hex: &str) -> Option<Vec<u8>> {
    (0..hex.len())
        .step_by(2)
        .map(|at| u8::from_str_radix(hex.get(at..at + 2)?, 16).ok())
        .collect()
}

fn main() {
    let hex = std::env::args().nth(1).unwrap_or_default();
    let frame = bytes_of(&hex).unwrap_or_default();
    match EstimatedAttitudeAngles::from_bytes(&frame) {
        Ok(angles) => {
            println!(
                "roll  {:7}  {:8.2} deg",
                angles.estimated_roll_angle,
                angles.estimated_roll_angle_deg()
            );
            println!(
                "pitch {:7}  {:8.2} deg",
                angles.estimated_pitch_angle,
                angles.estimated_pitch_angle_deg()
            );
            println!(
                "yaw   {:7}  {:8.2} deg",
                angles.estimated_yaw_angle,
                angles.estimated_yaw_angle_deg()
            );
        }
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(1);
        }
    }
}

//! cargo-fuzz harness on the sum types of the generated crate. See README.md.
#![no_main]

use icd::Error;
use libfuzzer_sys::fuzz_target;

const DIRECTION: u8 = 1;
const FIT: u8 = 2;
const HIGH_ID: u8 = 4;

fn repeated(data: &[u8], length: usize) -> Vec<u8> {
    (0..length).map(|i| if data.is_empty() { 0 } else { data[i % data.len()] }).collect()
}

macro_rules! exercise {
    ($sum:ty, $id:expr, $fit:expr, $data:expr) => {{
        let Ok(id) = $id.try_into() else { return };
        let mut frame = $data.to_vec();
        let mut result = <$sum>::from_bytes(id, &frame);
        if let (true, Err(Error::Length { expected, actual })) = ($fit, &result) {
            assert_ne!(expected, actual);
            frame = repeated($data, *expected);
            result = <$sum>::from_bytes(id, &frame);
            assert!(result.is_ok());
        }
        match result {
            Ok(message) => {
                assert_eq!(message.id(), id);
                assert_eq!(message.length(), frame.len());
                let mut first = vec![0xA5; message.length()];
                assert_eq!(message.write_to(&mut first), Ok(frame.len()));
                let again = <$sum>::from_bytes(id, &first).unwrap();
                let mut second = vec![0x5A; frame.len() + 1];
                assert_eq!(again.write_to(&mut second), Ok(frame.len()));
                assert_eq!(first[..], second[..frame.len()]);
                assert_eq!(second[frame.len()], 0x5A);
                if !frame.is_empty() {
                    assert!(message.write_to(&mut first[1..]).is_err());
                }
                let _ = (message.name(), format!("{message:?}"));
            }
            Err(error) => {
                let _ = error.to_string();
            }
        }
    }};
}

fuzz_target!(|input: &[u8]| {
    let [node, flags, low, data @ ..] = input else { return };
    let id = u16::from(*low) + if flags & HIGH_ID != 0 { 256 } else { 0 };
    let (telemetry, fit) = (flags & DIRECTION != 0, flags & FIT != 0);
    let _ = (id, telemetry, fit, data);
    include!("nodes.rs");
});

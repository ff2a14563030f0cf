//! cargo-fuzz harness on the sum types of the generated crate. See README.md.
#![no_main]

use icd::Error;
use libfuzzer_sys::fuzz_target;

const DIRECTION: u8 = 1;
const FIT: u8 = 2;
const AS_ID: u8 = 4;
const LONGEST: usize = 65_535; // bytes of a frame; a field that counts may tell of more

fn repeated(data: &[u8], length: usize) -> Vec<u8> {
    (0..length).map(|i| if data.is_empty() { 0 } else { data[i % data.len()] }).collect()
}

macro_rules! exercise {
    ($sum:ty, $ids:expr, $flags:expr, $number:expr, $data:expr) => {{
        let (ids, number): (&[u32], _) = (&$ids, *$number);
        let picked = if $flags & AS_ID != 0 { u32::from(number) } else { ids[usize::from(number) % ids.len()] };
        let Ok(id) = picked.try_into() else { return };
        let mut frame = $data.to_vec();
        let mut result = <$sum>::from_bytes(id, &frame);
        if let (true, Err(Error::Length { expected, actual })) = ($flags & FIT != 0, &result) {
            assert_ne!(expected, actual);
            if *expected <= LONGEST {
                frame = repeated($data, *expected);
                result = <$sum>::from_bytes(id, &frame);
            }
        }
        match result {
            Ok(message) => {
                assert_eq!(message.id(), id);
                let size = message.length();
                assert!(frame.len() <= size); // zeros may be cut off
                let mut first = vec![0xA5; size];
                assert_eq!(message.write_to(&mut first), Ok(size));
                let again = <$sum>::from_bytes(id, &first).unwrap();
                assert_eq!(again.name(), message.name());
                let mut second = vec![0x5A; size + 1];
                assert_eq!(again.write_to(&mut second), Ok(size));
                assert_eq!(first[..], second[..size]);
                assert_eq!(second[size], 0x5A);
                if size != 0 {
                    assert!(message.write_to(&mut first[1..]).is_err());
                }
                let _ = (message.to_string(), format!("{message:?}"));
            }
            Err(Error::UnknownId { .. }) => {}
            Err(error) => {
                assert!(ids.contains(&picked));
                let _ = error.to_string();
            }
        }
    }};
}

fuzz_target!(|input: &[u8]| {
    let [node, flags, number, data @ ..] = input else { return };
    let telemetry = flags & DIRECTION != 0;
    let _ = (number, telemetry, data);
    include!("nodes.rs");
});

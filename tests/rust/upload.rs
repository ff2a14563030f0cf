//! Uploads a program over a link with header and trailer: HOST PORT SIZE

use icd::loader::enums::Area;
use icd::loader::procedures::{Upload, UPLOAD_MEMORY};
use icd::loader::{ImageChecksum, LINK, LONGEST, SEQUENCES};
use icd::wire::procedure::End;
use icd::wire::session::Failure;
use icd::wire::{stream, Error, Session};
use std::net::TcpStream;
use std::time::Duration;

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let port = TcpStream::connect(format!("{}:{}", words[1], words[2])).unwrap();
    port.set_read_timeout(Some(Duration::from_millis(5))).unwrap();
    let mut session = Session::<_, _, stream::Line<LONGEST, SEQUENCES>>::new(&LINK, port).unwrap();
    let size: u32 = words[3].parse().unwrap();
    let image: Vec<u8> = (0..size).map(|number| (number % 251) as u8).collect();
    let mut memory = [0; UPLOAD_MEMORY];
    let mut upload = Upload::new(Area::Backup, &image, &mut memory).unwrap();
    match session.run(&mut upload) {
        Ok(()) => {
            assert_eq!(upload.progress(), (size, Some(size)));
            println!("{}", session.get::<ImageChecksum>().unwrap().checksum);
        }
        Err(Failure::Procedure(end)) => {
            assert_eq!(end, End::Refused);
            println!("{end:?}");
        }
        Err(other) => panic!("{other}"),
    }
    let too_large = vec![0; 1 << 24];
    let error = Upload::new(Area::Backup, &too_large, &mut memory).err();
    assert!(matches!(error, Some(Error::TooLong { .. })));
    let error = Upload::new(Area::Backup, &image, &mut []).err();
    assert!(matches!(error, Some(Error::Length { expected: 1, actual: 0 })));
}

//! Uses the generated crate as a flight program would; any surprise is a panic.

use icd::common::Reset;
use icd::cubeacp::enums::{ConModeSelect, EstimModeSelect};
use icd::cubeacp::{AdcsConfiguration, CurrentAdcsState, EstimatedAttitudeAngles, SetAttitudeControlMode, Telecommand, Telemetry};
use icd::common::enums::{FileType, TcErrorReason};
use icd::cubeacp::procedures::{Download, DOWNLOAD_MEMORY};
use icd::wire::procedure::End;
use icd::wire::{can, checksum, identify, uart, Client, Crc, Direction, Event, Link, Table};

type Uart = Client<icd::cubeacp::Node, uart::Line<{ icd::cubeacp::LONGEST }>, 1>;

const ROOM: usize = 2 * icd::cubeacp::LONGEST + 4;
use icd::{Coded, Error, Message};

fn main() {
    reading();
    describing();
    writing();
    enumerations();
    dispatching();
    floats();
    requesting();
    sending();
    downloading();
    checking();
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
        assert_eq!(error, Error::Range { field: "Estimated Yaw Angle", allowed: "-327.68 to 327.67 deg" });
        assert_eq!(error.to_string(), "`Estimated Yaw Angle` takes -327.68 to 327.67 deg");
        assert_eq!(angles.estimated_yaw_angle, 3);
    }
    assert_eq!(angles.estimated_roll_angle_mdeg(), -12_340);
    assert_eq!(angles.estimated_roll_angle_deg_f32(), -12.34_f32);
    assert_eq!(angles.set_estimated_roll_angle_mdeg(12_345), Ok(()));
    assert_eq!(angles.estimated_roll_angle, 1234, "a tie goes to the even one");
    assert_eq!(angles.set_estimated_roll_angle_mdeg(327_676), Err(Error::Range { field: "Estimated Roll Angle", allowed: "-327.68 to 327.67 deg" }));
    assert_eq!(angles.set_estimated_roll_angle_mdeg(-327_685), Ok(()), "a tie again");
    assert_eq!(angles.estimated_roll_angle, -32_768);
    for length in [0, 5, 7, 512] {
        let error = EstimatedAttitudeAngles::from_bytes(&vec![0; length]).unwrap_err();
        assert_eq!(error, Error::Length { expected: 6, actual: length });
        assert_eq!(error.to_string(), format!("6 bytes expected, {} given", length));
    }
    assert_eq!(EstimatedAttitudeAngles::from_array(&angles.to_bytes().unwrap()), angles);
}

/// What is generic over messages.
fn describing() {
    fn told<M: Message>(bytes: &[u8]) -> String {
        let message = M::from_bytes(bytes).unwrap();
        assert_eq!(message.to_bytes().unwrap().as_ref(), bytes);
        format!("{message}")
    }
    let roll = EstimatedAttitudeAngles::FIELDS[0];
    assert_eq!((roll.name, roll.at, roll.bits, roll.unit), ("Estimated Roll Angle", 0, 16, "deg"));
    assert_eq!((roll.physical(-1234), roll.raw(-12.34)), (Some(-12.34), Some(Ok(-1234))));
    assert_eq!(
        told::<EstimatedAttitudeAngles>(&[0x2e, 0xfb, 0x0a, 0, 0, 0]),
        "Estimated Attitude Angles: Estimated Roll Angle -12.34 deg, Estimated Pitch Angle 0.1 deg, Estimated Yaw Angle 0 deg"
    );
    assert_eq!(<EstimatedAttitudeAngles as icd::Telemetry>::TELEMETRY_ID, 146);
    let frame: &[u8] = &[3, 0, 0];
    let command: SetAttitudeControlMode = frame.try_into().unwrap();
    let mode = ConModeSelect::from(3);
    assert_eq!((command.control_mode.known(), command.control_mode.to_string()), (Some(mode), mode.to_string()));
    assert_eq!(mode.to_string(), mode.name().unwrap());
    let unknown = Coded::<ConModeSelect>::from_raw(200);
    assert_eq!((unknown.known(), unknown.to_string()), (None, "200".into()));
    let limited = icd::cubeacp::AdcsConfiguration::FIELDS.iter().filter(|field| !field.limits.is_empty());
    assert!(limited.count() > 0);
}

fn writing() {
    assert_eq!(Reset::default().to_bytes(), Ok([Reset::MAGIC_NUMBER_CONST]));
    let command = SetAttitudeControlMode {
        control_mode: ConModeSelect::from(3).into(),
        timeout: SetAttitudeControlMode::TIMEOUT_NO_TIMEOUT,
    };
    assert_eq!(command.to_bytes(), Ok([3, 0xff, 0xff]));
    assert_eq!(SetAttitudeControlMode::LENGTH, 3);
    let mut state = CurrentAdcsState::default();
    assert_eq!(state.to_bytes(), Ok([0; 6]));
    state.control_mode = Coded::from_raw(0x1e);
    assert_eq!(state.to_bytes(), Err(Error::Range { field: "Control Mode", allowed: "ConModeSelect, 0 to 15" }));
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
    let encoded = configuration.to_bytes().unwrap();
    let again = AdcsConfiguration::from_bytes(&encoded).unwrap();
    assert_eq!(again.to_bytes(), Ok(encoded), "signalling NaNs are kept");
}

fn requesting() {
    let mut client = Uart::uart(&icd::cubeacp::LINK).unwrap();
    let before = u32::MAX - 5; // time wraps while the reply is awaited
    client.request::<EstimatedAttitudeAngles>(before).unwrap();
    assert_eq!(client.request::<CurrentAdcsState>(before), Err(icd::wire::Error::Busy));
    let mut line = [0; 32];
    assert!(client.output(&mut [0; 4]).is_err(), "no room");
    assert_eq!(client.output(&mut line), Ok(Some(&[0x1f, 0x7f, 146, 0x1f, 0xff][..])));
    assert_eq!(client.output(&mut line), Ok(None));
    let size = uart::encode(&icd::cubeacp::LINK, &[146, 0x2e, 0xfb, 0x0a, 0, 0, 0], &mut line).unwrap();
    let mut angles = None;
    for byte in &line[..size] {
        client.received(before.wrapping_add(50), &[*byte], |event| angles = event.message::<EstimatedAttitudeAngles>());
    }
    assert_eq!(angles.unwrap().estimated_roll_angle, -1234);
    assert_eq!(client.deadline(), None);
    assert!(Client::<_, uart::Line<16>, 1>::uart(&icd::cubeacp::LINK).is_err(), "a buffer that is too small");
}

fn sending() {
    let mut client = Client::<_, can::Line<{ icd::cubeacp::LONGEST }>, 1>::can(&icd::cubeacp::LINK, 7).unwrap();
    client.send(0, &Reset::default()).unwrap(); // it is answered by a reset
    let packet = client.output_packet().unwrap();
    assert_eq!((packet.id, packet.data()), (0x0101_0701, &[90][..]));
    assert!(client.output_packet().is_none());
    let mut ended = false;
    client.tick(0, |event| ended = matches!(*event, Event::Sent { .. }));
    assert!(ended);
    several_packets();
    let mut client = Uart::uart(&icd::cubeacp::LINK).unwrap().with_checksums();
    let command = SetAttitudeControlMode::default();
    client.send(10, &command).unwrap();
    let mut room = [0; ROOM];
    let sent = client.output(&mut room).unwrap();
    assert_eq!(sent.map(<[u8]>::len), Some(4 + 1 + 3 + 1));
    let mut seen = Vec::new();
    client.received(20, &[0x1f, 0x7f, 13, 3, 0x1f, 0xff], |event| {
        let is_damaged = matches!(*event, Event::Refused { may_be_damaged: true, .. });
        seen.push((event.reason(), is_damaged));
    });
    assert_eq!(seen, [(Some(TcErrorReason::IncorrectParameter), false)]);
}

/// The packets of a message are taken one by one; nothing comes between them.
fn several_packets() {
    let mut client = Client::<_, can::Line<{ icd::cubeacp::LONGEST }>, 2>::can(&icd::cubeacp::LINK, 7).unwrap();
    let packets = |client: &mut Client<_, _, 2>| std::iter::from_fn(|| client.output_packet()).count();
    client.send(0, &AdcsConfiguration::default()).unwrap();
    client.request::<CurrentAdcsState>(0).unwrap();
    let all = packets(&mut client);
    assert!(all > 70, "and the request waits");
    client.cancel();
    client.send(10_000, &AdcsConfiguration::default()).unwrap();
    client.send(10_000, &Reset::default()).unwrap();
    assert!(client.output_packet().is_some());
    client.tick(10_000, |event| panic!("{event:?}"));
    client.cancel_request(Direction::Telecommand, AdcsConfiguration::SET_ID.into());
    assert_eq!(packets(&mut client), 1, "the remaining packets are dropped");
}

/// A node that has one file, and loses every third packet.
struct Node {
    file: Vec<u8>,
    block: Vec<u8>,
    burst: bool,
    sent: usize,
}

impl Node {
    fn answer(&mut self, link: &'static Link, message: &[u8]) -> Vec<Vec<u8>> {
        match message {
            [112, data @ ..] => {
                let offset = u32::from_le_bytes(data[2..6].try_into().unwrap()) as usize;
                let length = u16::from_le_bytes(data[6..8].try_into().unwrap()) as usize;
                self.block = self.file[offset..offset + length].to_vec();
            }
            [242] => {
                let [low, high, ..] = checksum(link, "crc16", &self.block).unwrap().to_le_bytes();
                let length = self.block.len() as u16;
                return vec![[&[242, 1, low, high][..], &length.to_le_bytes()].concat()];
            }
            [119, ..] => self.burst = true,
            _ => {}
        }
        let mut out = vec![vec![message[0], 0]];
        if std::mem::take(&mut self.burst) {
            for (number, packet) in self.block.chunks(20).enumerate() {
                self.sent += 1;
                if self.sent % 3 != 0 {
                    let mut bytes = [&[119][..], &(number as u16).to_le_bytes(), packet].concat();
                    bytes.resize(23, 0xff);
                    out.push(bytes);
                }
            }
        }
        out
    }
}

fn downloading() {
    let link = &icd::cubeacp::LINK;
    let mut client = Uart::uart(link).unwrap();
    let file: Vec<u8> = (0..45_000_u32).map(|n| (n * n >> 3) as u8).collect();
    let mut node = Node { file: file.clone(), block: Vec::new(), burst: false, sent: 0 };
    let (mut memory, mut found) = (vec![0; DOWNLOAD_MEMORY], Vec::new());
    let mut hears = uart::Decoder::<{ icd::cubeacp::LONGEST }>::new(link).unwrap();
    let size = Some(45_000);
    let on_block = |offset, block: &[u8]| {
        assert_eq!(offset as usize, found.len());
        found.extend_from_slice(block);
    };
    let too_large = Download::new(FileType::from(2), 1, Some(1 << 30), &mut [0; 99], |_, _| {}).err().unwrap();
    assert_eq!(too_large.to_string(), "`size` takes 0 to 16777216");
    let mut little = [0; 50]; // two packets and their bits
    let mut smaller = Download::new(FileType::from(2), 1, size, &mut little, |_, _| {}).unwrap();
    assert_eq!(smaller.next(0).unwrap().data, [2, 1, 0, 0, 0, 0, 40, 0]);
    let mut download = Download::new(FileType::from(2), 1, size, &mut memory, on_block).unwrap();
    let mut now = 0_u32;
    while download.result().is_none() {
        assert!(now < 1_000_000);
        while client.advance(now, &mut download).unwrap() {}
        let mut answers = Vec::new();
        let mut room = [0; ROOM];
        while let Some(bytes) = client.output(&mut room).unwrap() {
            hears.feed(bytes, |event| {
                if let uart::Event::Message(message) = event {
                    answers.extend(node.answer(link, message));
                }
            });
        }
        for message in answers {
            let mut line = [0; 64];
            let size = uart::encode(link, &message, &mut line).unwrap();
            client.received(now, &line[..size], |event| download.event(now, &event));
        }
        let deadlines = [client.deadline(), download.deadline()];
        now = deadlines.iter().flatten().copied().min().unwrap_or(now).max(now);
        client.tick(now, |event| download.event(now, &event));
    }
    assert_eq!(download.result(), Some(End::Done));
    assert_eq!(download.progress(), (45_000, size));
    drop(download);
    assert!(found == file);
}

fn checking() {
    let link = &icd::cubeacp::LINK;
    let mut checksums = link.checksums.iter();
    let form = checksums.find(|(name, _)| *name == "crc16").unwrap().1.crc;
    let table = Table::new(&form);
    let mut fast = Crc::with_table(&form, &table);
    fast.feed(b"1234");
    fast.feed(b"56789");
    assert_eq!((fast.result(), checksum(link, "crc16", b"123456789")), (0x31c3, Ok(0x31c3)));
    let form = link.checksum.unwrap().algorithm.crc;
    let table = Table::new(&form);
    for bytes in [&b""[..], b"1", b"123456789"] {
        let mut fast = Crc::with_table(&form, &table);
        fast.feed(bytes);
        assert_eq!(Ok(fast.result()), checksum(link, "crc8", bytes));
    }
    let node = identify(link, &[10, 7, 0, 0, 0, 0, 0, 0]).unwrap();
    assert!(node.matches && node.node_type == 10);
    assert!(!identify(link, &[11, 7, 0, 0, 0, 0, 0, 0]).unwrap().matches);
}
